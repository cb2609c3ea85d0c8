// coded_neutral.hpp - the neutral of a map in blocks, coded before anything else: differences are to what it decodes
// to.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "bands/map_set.hpp"
#include "blocks/block_decoder.hpp"
#include "blocks/block_encoder.hpp"
#include "device/device_context.hpp"
#include "facezip/progress.hpp"

namespace facezip::compress {

struct CodedNeutral {
  blocks::BlockFormat format = blocks::BlockFormat::kBc7;
  int width = 0;  ///< texels
  int height = 0;
  int channels = 0;
  std::vector<std::byte> blocks;  ///< [block row][block column]

  /// Blocks of rows [begin, end): whole rows of blocks, but for the image's last.
  std::span<const std::byte> rows(int begin, int end) const;
};

/// Gives rows [begin, end) of a neutral as blocks::TexelRows has samples; called from top to bottom.
using ReadNeutral = std::function<decltype(blocks::TexelRows::samples)(int begin, int end)>;

/// Codes the neutral of a map whose texels are of these classes. Covered texels count most.
/// name  of the map. Throws InputError, DeviceError, Cancelled.
CodedNeutral codeNeutral(device::DeviceContext& context, const image::ImageShape& shape,
                         const raster::TexelClasses& classes, const ReadNeutral& read, blocks::BlockFormat format,
                         blocks::Quality quality, const std::string& name, Progress& progress);

/// Codes the captured neutral of a map of 8-bit samples. Likewise.
CodedNeutral codeNeutral(device::DeviceContext& context, const OpenMap& map, blocks::BlockFormat format,
                         blocks::Quality quality, Progress& progress);

/// Decodes rows of a coded neutral.
class DecodedNeutral {
 public:
  /// neutral  must outlive this
  explicit DecodedNeutral(const CodedNeutral& neutral);

  /// Rows [begin, end), rows x width x channels, in units of 1/255. Rows as CodedNeutral::rows() takes them. The next
  /// call overwrites them.
  std::span<const float> rows(int begin, int end);

 private:
  const CodedNeutral& neutral_;
  std::unique_ptr<blocks::BlockDecoder> decoder_;
  std::vector<float> texels_;
};

}  // namespace facezip::compress
