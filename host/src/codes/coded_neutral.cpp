#include "codes/coded_neutral.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>

#include "codes/block_weights.hpp"
#include "image/image_file.hpp"
#include "io/counts.hpp"

namespace facezip::compress {
namespace {

/// Rows that are coded at a time: enough to spread over threads, and whole blocks of every height (120 = lcm of 4, 5,
/// 6, 8, 10 and 12).
constexpr int kRowsAtOnce = 240;

}  // namespace

std::span<const std::byte> CodedNeutral::rows(int begin, int end) const {
  const int block_height = blocks::infoOf(format).block_height;
  assert(begin % block_height == 0 && (end % block_height == 0 || end == height));
  const std::size_t row = blocks::blockBytes(format, width, block_height);
  const auto first = toSize(begin / block_height) * row;
  return std::span(blocks).subspan(first, blocks::blockBytes(format, width, end - begin));
}

CodedNeutral codeNeutral(device::DeviceContext& context, const image::ImageShape& shape,
                         const raster::TexelClasses& classes, const ReadNeutral& read, blocks::BlockFormat format,
                         blocks::Quality quality, const std::string& name, Progress& progress) {
  CodedNeutral coded{format, shape.width, shape.height, shape.channels, {}};
  coded.blocks.resize(blocks::blockBytes(format, shape.width, shape.height));
  blocks::EncoderOptions options;
  options.format = format;
  options.channels = shape.channels;
  options.quality = quality;
  const auto encoder = blocks::makeBlockEncoder(context, options);
  progress.stage(fmt::format("coding the neutral: {}", name), toSize(shape.height));
  const std::size_t row_blocks = blocks::blockBytes(format, shape.width, blocks::infoOf(format).block_height);
  for (int begin = 0; begin < shape.height; begin += kRowsAtOnce) {
    progress.checkCancelled();
    const int end = std::min(begin + kRowsAtOnce, shape.height);
    const std::vector<float> weights = neutralBlockWeights(classes, begin, end);
    const std::size_t first = toSize(begin / blocks::infoOf(format).block_height) * row_blocks;
    encoder->encode({.width = shape.width,
                     .rows = end - begin,
                     .channels = shape.channels,
                     .samples = read(begin, end),
                     .weights = weights},
                    std::span(coded.blocks).subspan(first, blocks::blockBytes(format, shape.width, end - begin)), {});
    progress.advance(toSize(end));
  }
  return coded;
}

CodedNeutral codeNeutral(device::DeviceContext& context, const OpenMap& map, blocks::BlockFormat format,
                         blocks::Quality quality, Progress& progress) {
  const image::ImageShape& shape = map.samples->shape();
  assert(shape.type == image::SampleType::kUint8);
  image::ImageReader reader(map.source->neutral);
  std::vector<std::byte> samples;
  const auto read = [&](int begin, int end) {
    samples.resize(toSize(end - begin) * shape.rowBytes());
    reader.readRows(begin, end, samples);
    return std::span(reinterpret_cast<const std::uint8_t*>(samples.data()), samples.size());
  };
  return codeNeutral(context, shape, *map.classes, read, format, quality, map.source->name, progress);
}

DecodedNeutral::DecodedNeutral(const CodedNeutral& neutral)
    : neutral_(neutral), decoder_(blocks::makeBlockDecoder(neutral.format, neutral.channels)) {}

std::span<const float> DecodedNeutral::rows(int begin, int end) {
  texels_.resize(toSize(end - begin, neutral_.width, neutral_.channels));
  decoder_->decode(neutral_.width, end - begin, neutral_.rows(begin, end), std::span(texels_));
  return texels_;
}

}  // namespace facezip::compress
