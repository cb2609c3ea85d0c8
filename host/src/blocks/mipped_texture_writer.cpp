#include "blocks/mipped_texture_writer.hpp"

#include <algorithm>

#include "io/counts.hpp"

namespace facezip::blocks {
namespace {

/// Rows of blocks that are coded at a time: enough to spread over threads.
constexpr int kBlockRowsAtOnce = 16;
/// What texels of which nothing is covered count in a block beside others.
constexpr float kLeastWeight = 1.0f / 64.0f;

BlockTexture textureOf(BlockFormat format, int width, int height) {
  return {format, width, height, mostLevels(width, height), false};
}

}  // namespace

MippedTextureWriter::MippedTextureWriter(device::DeviceContext& context, const std::filesystem::path& path, int width,
                                         int height, const EncoderOptions& options)
    : options_(options),
      width_(width),
      file_(path, textureOf(options.format, width, height)),
      decoder_(makeBlockDecoder(options.format, options.channels)),
      encoder_(makeBlockEncoder(context, options)),
      chain_(width, height, options.channels, mostLevels(width, height),
             [this](int level, int y, std::span<const float> texels, std::span<const float> weights) {
               take(level, y, texels, weights);
             }) {
  for (int level = 0; level < mostLevels(width, height); ++level) {
    levels_.push_back({levelSide(width, level), levelSide(height, level), 0, {}, {}});
  }
}

void MippedTextureWriter::append(int rows, std::span<const std::byte> blocks, std::span<const float> coverage) {
  file_.append(0, blocks);
  decoded_.resize(toSize(rows, width_, options_.channels));
  decoder_->decode(width_, rows, blocks, std::span(decoded_));
  chain_.push(decoded_, coverage);
}

void MippedTextureWriter::take(int level, int y, std::span<const float> texels, std::span<const float> weights) {
  Level& to = levels_[toSize(level)];
  to.texels.insert(to.texels.end(), texels.begin(), texels.end());
  for (const float weight : weights) to.weights.push_back(std::max(weight, kLeastWeight));
  to.next_row = y + 1;
  const int waiting = static_cast<int>(to.weights.size()) / to.width;
  if (to.next_row == to.height || waiting == kBlockRowsAtOnce * infoOf(options_.format).block_height) code(level);
}

void MippedTextureWriter::code(int level) {
  Level& from = levels_[toSize(level)];
  const int rows = static_cast<int>(from.weights.size()) / from.width;
  blocks_.resize(blockBytes(options_.format, from.width, rows));
  encoder_->encode({.width = from.width,
                    .rows = rows,
                    .channels = options_.channels,
                    .samples = std::span<const float>(from.texels),
                    .weights = from.weights},
                   blocks_, {});
  file_.append(level, blocks_);
  from.texels.clear();
  from.weights.clear();
}

void MippedTextureWriter::close() { file_.close(); }

}  // namespace facezip::blocks
