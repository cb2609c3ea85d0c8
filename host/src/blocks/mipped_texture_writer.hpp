// mipped_texture_writer.hpp - a texture of blocks on disk whose mip levels are made of what its blocks decode to.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "blocks/block_decoder.hpp"
#include "blocks/block_encoder.hpp"
#include "blocks/mip_chain.hpp"
#include "blocks/texture_file.hpp"
#include "device/device_context.hpp"

namespace facezip::blocks {

class MippedTextureWriter {
 public:
  /// width, height  texels of level 0
  /// options        how levels from 1 on are coded; level 0 comes coded
  /// Throws InputError, OutputError as TextureFileWriter does.
  MippedTextureWriter(device::DeviceContext& context, const std::filesystem::path& path, int width, int height,
                      const EncoderOptions& options);

  /// The next rows of level 0: whole rows of blocks, but for the last.
  /// blocks    [block row][block column]
  /// coverage  rows x width, from 0 to 1: what a texel counts in the levels below (MipChain)
  /// Throws DeviceError, OutputError.
  void append(int rows, std::span<const std::byte> blocks, std::span<const float> coverage);

  /// Ends the file, of which all rows are there. Throws OutputError.
  void close();

 private:
  /// Rows of a level that wait to be coded.
  struct Level {
    int width = 0;
    int height = 0;
    int next_row = 0;  // to come in
    std::vector<float> texels;
    std::vector<float> weights;
  };
  void take(int level, int y, std::span<const float> texels, std::span<const float> weights);
  void code(int level);

  EncoderOptions options_;
  int width_;
  TextureFileWriter file_;
  std::unique_ptr<BlockDecoder> decoder_;
  std::unique_ptr<BlockEncoder> encoder_;
  MipChain chain_;
  std::vector<Level> levels_;
  std::vector<float> decoded_;
  std::vector<std::byte> blocks_;
};

}  // namespace facezip::blocks
