#include "blocks/astc_uneven_blocks.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace facezip::blocks {

UnevenBlocks::UnevenBlocks(BlockFormat format, int width, int rows, std::span<const float> weights,
                           std::span<const float> rgba)
    : format_(format), width_(width) {
  if (weights.empty()) return;
  const BlockFormatInfo& info = infoOf(format);
  const auto at = [width](int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
  };
  std::vector<float> largest;
  std::size_t index = 0;
  for (int y = 0; y < rows; y += info.block_height) {
    for (int x = 0; x < width; x += info.block_width, ++index) {
      const Block block{index, x, y, std::min(info.block_width, width - x), std::min(info.block_height, rows - y)};
      float most = 0.0f;
      float least = weights[at(x, y)];
      for (int row = 0; row < block.rows; ++row) {
        const auto [low, high] =
            std::minmax_element(&weights[at(x, y + row)], &weights[at(x, y + row)] + block.columns);
        least = std::min(least, *low);
        most = std::max(most, *high);
      }
      if (least == most) continue;
      blocks_.push_back(block);
      largest.push_back(most);
    }
  }
  const std::size_t texels = blocks_.size() * static_cast<std::size_t>(info.block_width * info.block_height);
  wanted_.resize(4 * texels);
  weights_.resize(texels);
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    const Block& block = blocks_[b];
    for (int row = 0; row < block.rows; ++row) {
      for (int column = 0; column < block.columns; ++column) {
        const std::size_t from = at(block.x + column, block.y + row);
        const std::size_t to = stripTexel(b, column, row);
        weights_[to] = weights[from] / largest[b];
        std::copy_n(&rgba[4 * from], 4, &wanted_[4 * to]);
      }
    }
  }
}

std::size_t UnevenBlocks::stripTexel(std::size_t block, int column, int row) const {
  const BlockFormatInfo& info = infoOf(format_);
  const auto side = static_cast<std::size_t>(info.block_width);
  return (static_cast<std::size_t>(row) * blocks_.size() + block) * side + static_cast<std::size_t>(column);
}

/// Texels of a block, row by row: those without weight become the mean of the others, then, a few times over, that of
/// their neighbours.
void UnevenBlocks::fillGaps(std::size_t b, std::span<std::array<float, 4>> texels) const {
  const Block& block = blocks_[b];
  const auto at = [&](int column, int row) { return static_cast<std::size_t>(row * block.columns + column); };
  std::array<float, 4> mean{};
  std::vector<std::pair<int, int>> gaps;
  for (int row = 0; row < block.rows; ++row) {
    for (int column = 0; column < block.columns; ++column) {
      const std::size_t from = stripTexel(b, column, row);
      std::copy_n(&wanted_[4 * from], 4, texels[at(column, row)].begin());
      if (weights_[from] == 0.0f) gaps.emplace_back(column, row);
      for (std::size_t c = 0; c < 4; ++c) mean[c] += weights_[from] == 0.0f ? 0.0f : wanted_[4 * from + c];
    }
  }
  for (float& value : mean)
    value /= static_cast<float>(static_cast<std::size_t>(block.columns * block.rows) - gaps.size());
  for (const auto& [column, row] : gaps) texels[at(column, row)] = mean;
  for (int round = 0; round < 8; ++round) {
    for (const auto& [column, row] : gaps) {
      const int left = std::max(column - 1, 0), right = std::min(column + 1, block.columns - 1);
      const int above = std::max(row - 1, 0), below = std::min(row + 1, block.rows - 1);
      for (std::size_t c = 0; c < 4; ++c) {
        texels[at(column, row)][c] = 0.25f * (texels[at(left, row)][c] + texels[at(right, row)][c] +
                                              texels[at(column, above)][c] + texels[at(column, below)][c]);
      }
    }
  }
}

void UnevenBlocks::fillGaps(std::span<float> rgba) const {
  const BlockFormatInfo& info = infoOf(format_);
  std::vector<std::array<float, 4>> texels(static_cast<std::size_t>(info.block_width * info.block_height));
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    const Block& block = blocks_[b];
    fillGaps(b, texels);
    for (int row = 0; row < block.rows; ++row) {
      const std::size_t line = static_cast<std::size_t>(block.y + row) * static_cast<std::size_t>(width_) +
                               static_cast<std::size_t>(block.x);
      for (int column = 0; column < block.columns; ++column) {
        const std::array<float, 4>& texel = texels[static_cast<std::size_t>(row * block.columns + column)];
        std::copy_n(texel.begin(), 4, &rgba[4 * (line + static_cast<std::size_t>(column))]);
      }
    }
  }
}

double UnevenBlocks::error(std::size_t block, const std::array<float, 4>& channel_weights,
                           std::span<const float> decoded) const {
  double sum = 0.0;
  for (int row = 0; row < blocks_[block].rows; ++row) {
    for (int column = 0; column < blocks_[block].columns; ++column) {
      const std::size_t texel = stripTexel(block, column, row);
      for (std::size_t c = 0; c < 4; ++c) {
        const float rest = wanted_[4 * texel + c] - decoded[4 * texel + c];
        sum += static_cast<double>(weights_[texel] * channel_weights[c] * rest * rest);
      }
    }
  }
  return sum;
}

void UnevenBlocks::improve(AstcCodec& codec, const std::array<float, 4>& channel_weights,
                           std::span<std::byte> blocks) const {
  if (blocks_.empty()) return;
  const BlockFormatInfo& info = infoOf(format_);
  const int width = static_cast<int>(blocks_.size()) * info.block_width;
  const auto block_bytes = static_cast<std::size_t>(info.block_bytes);
  std::vector<std::byte> before(blocks_.size() * block_bytes);
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    std::memcpy(&before[b * block_bytes], &blocks[blocks_[b].index * block_bytes], block_bytes);
  }
  std::vector<float> decoded(wanted_.size());
  codec.decompress(width, info.block_height, before, std::span(decoded));
  std::vector<float> targets(wanted_.size());
  for (std::size_t i = 0; i < targets.size(); ++i) targets[i] = std::lerp(decoded[i], wanted_[i], weights_[i / 4]);
  std::vector<std::byte> after(before.size());
  codec.compress(width, info.block_height, std::span(targets), after);
  std::vector<float> redecoded(wanted_.size());
  codec.decompress(width, info.block_height, after, std::span(redecoded));
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    if (error(b, channel_weights, redecoded) >= error(b, channel_weights, decoded)) continue;
    std::memcpy(&blocks[blocks_[b].index * block_bytes], &after[b * block_bytes], block_bytes);
  }
}

}  // namespace facezip::blocks
