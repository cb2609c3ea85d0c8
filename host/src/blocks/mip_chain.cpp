#include "blocks/mip_chain.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <utility>

#include "blocks/block_texture.hpp"

namespace facezip::blocks {
namespace {

/// Shares of texels 2 i, 2 i + 1 and 2 i + 2 in texel i of the level below.
std::array<float, 3> sharesOf(int texels, int i) {
  if (texels == 1) return {1.0f, 0.0f, 0.0f};
  if (texels % 2 == 0) return {0.5f, 0.5f, 0.0f};
  const int half = texels / 2;
  const float per = 1.0f / static_cast<float>(texels);
  return {static_cast<float>(half - i) * per, static_cast<float>(half) * per, static_cast<float>(i + 1) * per};
}

int tapsOf(int texels) { return texels == 1 ? 1 : texels % 2 == 0 ? 2 : 3; }

}  // namespace

void MipChain::Sums::clear(std::size_t width, std::size_t channels) {
  weights.assign(width, 0.0f);
  weighted.assign(width * channels, 0.0f);
  plain.assign(width * channels, 0.0f);
}

void MipChain::Sums::add(float share, const Sums& row) {
  const auto addTo = [share](std::vector<float>& sums, const std::vector<float>& values) {
    for (std::size_t i = 0; i < sums.size(); ++i) sums[i] += share * values[i];
  };
  addTo(weights, row.weights);
  addTo(weighted, row.weighted);
  addTo(plain, row.plain);
}

MipChain::MipChain(int width, int height, int channels, int levels, Sink sink)
    : width_(width), channels_(static_cast<std::size_t>(channels)), sink_(std::move(sink)) {
  assert(levels >= 1 && levels <= mostLevels(width, height));
  for (int level = 0; level + 1 < levels; ++level) {
    Step step{levelSide(width, level), levelSide(height, level), 0, {}, {}};
    const auto out = static_cast<std::size_t>(levelSide(width, level + 1));
    for (Sums* sums : {&step.across, &step.down}) sums->clear(out, channels_);
    steps_.push_back(std::move(step));
  }
}

void MipChain::push(std::span<const float> texels, std::span<const float> weights) {
  if (steps_.empty()) return;
  const auto width = static_cast<std::size_t>(width_);
  const std::size_t row_samples = width * channels_;
  assert(texels.size() % row_samples == 0);
  assert(weights.empty() || weights.size() * channels_ == texels.size());
  if (weights.empty()) ones_.assign(width, 1.0f);
  for (std::size_t row = 0; row < texels.size() / row_samples; ++row) {
    take(0, texels.subspan(row * row_samples, row_samples),
         weights.empty() ? std::span<const float>(ones_) : weights.subspan(row * width, width));
  }
}

void MipChain::halveRow(Step& step, std::span<const float> texels, std::span<const float> weights) const {
  const int taps = tapsOf(step.width);
  Sums& row = step.across;
  row.clear(row.weights.size(), channels_);
  for (std::size_t x = 0; x < row.weights.size(); ++x) {
    const std::array<float, 3> shares = sharesOf(step.width, static_cast<int>(x));
    for (std::size_t tap = 0; tap < static_cast<std::size_t>(taps); ++tap) {
      const float weight = shares[tap] * weights[2 * x + tap];
      row.weights[x] += weight;
      for (std::size_t c = 0; c < channels_; ++c) {
        const float sample = texels[(2 * x + tap) * channels_ + c];
        row.weighted[x * channels_ + c] += weight * sample;
        row.plain[x * channels_ + c] += shares[tap] * sample;
      }
    }
  }
}

void MipChain::take(std::size_t index, std::span<const float> texels, std::span<const float> weights) {
  Step& step = steps_[index];
  const int y = step.next_row++;
  assert(y < step.height);
  halveRow(step, texels, weights);
  const int taps = tapsOf(step.height);
  // Row 2 i is the last of three that are row i - 1, and the first of row i.
  const int row = y / 2;
  const int tap = y % 2;
  if (taps == 3 && tap == 0) {
    if (row > 0) {
      step.down.add(sharesOf(step.height, row - 1)[2], step.across);
      emit(index, row - 1);
    }
    if (y + 1 < step.height) step.down.add(sharesOf(step.height, row)[0], step.across);
    return;
  }
  step.down.add(sharesOf(step.height, row)[static_cast<std::size_t>(tap)], step.across);
  if (taps < 3 && tap == taps - 1) emit(index, row);
}

void MipChain::emit(std::size_t index, int y) {
  Sums& row = steps_[index].down;
  std::vector<float>& texels = row.weighted;
  for (std::size_t x = 0; x < row.weights.size(); ++x) {
    const float weight = row.weights[x];
    for (std::size_t i = x * channels_; i < (x + 1) * channels_; ++i) {
      texels[i] = weight > 0.0f ? texels[i] / weight : row.plain[i];
    }
  }
  sink_(static_cast<int>(index) + 1, y, texels, row.weights);
  if (index + 1 < steps_.size()) take(index + 1, texels, row.weights);
  row.clear(row.weights.size(), channels_);
}

}  // namespace facezip::blocks
