// coded_textures.hpp - difference textures fitted and coded in blocks one after the other: each is the best that the
// decoded ones before it leave to ask for, at every texel. What blocks of one texture get wrong, the next ones mend.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "blocks/block_encoder.hpp"
#include "codes/texture_coder.hpp"
#include "refine/difference_fit.hpp"
#include "refine/grid_band.hpp"
#include "refine/texture_encoding.hpp"
#include "refine/weight_window.hpp"

namespace facezip::compress {

/// How the difference textures of a map are coded.
struct TextureCoding {
  std::vector<blocks::BlockFormat> formats;  ///< C
  std::vector<TextureEncoding> encoding;     ///< C x channels, zero a whole code
  int channels = 0;
};

class CodedTextures {
 public:
  /// keep_blocks  whether blocks() is asked for
  CodedTextures(device::DeviceContext& context, const WeightSpace& space, TextureCoding coding, blocks::Quality quality,
                bool keep_blocks);

  /// The tiles that the next compute() is of; may go afterwards.
  /// masks  raster::activeTiles(), weighed or not
  void setTiles(const TileMasks& masks);

  /// Fits and codes the textures of a band. Rows of the band are whole rows of blocks of every format, but for the
  /// image's last. Returns what the blocks decode to, [tile][C][channel][256] float in units of 1/255.
  /// ridge  as DifferenceFit::compute() takes it
  const cl::Buffer& compute(const GridBand& band, const WeightWindow& window, float ridge);

  /// What the last compute() leaves in every tile. Waits.
  std::vector<FitError> errors();
  /// Blocks of a texture of the last band, [block row][block column].
  std::span<const std::byte> blocks(int texture) const { return blocks_[toSize(texture)]; }

 private:
  void codeTexture(const CodedTiles& tiles, int texture);

  device::DeviceContext& context_;
  WeightSpace space_;
  TextureCoding coding_;
  bool keep_blocks_;
  std::vector<std::unique_ptr<TextureCoder>> coders_;  ///< of each texture
  DifferenceFit fit_;
  std::vector<TilePosition> positions_;
  std::vector<float> block_weights_;
  std::size_t tile_count_ = 0;
  std::vector<std::vector<std::byte>> blocks_;
  device::PooledBuffer block_weights_buffer_;
  device::PooledBuffer encoding_;
  device::PooledBuffer codes_;
  device::PooledBuffer textures_;
  device::PooledBuffer errors_;
};

/// Rows of the image that bands and windows begin at multiples of: whole rows of blocks of all formats.
int blockRowStep(std::span<const blocks::BlockFormat> formats);

}  // namespace facezip::compress
