#include "refine/grid_weights.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cstring>

#include "io/counts.hpp"

namespace facezip::compress {
namespace {

/// Finite halves in rising order have rising keys.
std::uint16_t keyOf(Eigen::half value) {
  const std::uint16_t bits = Eigen::numext::bit_cast<std::uint16_t>(value);
  return (bits & 0x8000u) != 0 ? static_cast<std::uint16_t>(~bits) : static_cast<std::uint16_t>(bits | 0x8000u);
}
float valueOf(std::uint16_t key) {
  const std::uint16_t bits =
      (key & 0x8000u) != 0 ? static_cast<std::uint16_t>(key & 0x7fffu) : static_cast<std::uint16_t>(~key);
  return static_cast<float>(Eigen::numext::bit_cast<Eigen::half>(bits));
}

}  // namespace

GridWeights::GridWeights(const WeightSpace& space)
    : space_(space), values_(space.cellCount() * toSize(space.textures, space.expressions), Eigen::half(0.0f)) {}

void GridWeights::store(int begin, int end, std::span<const float> rows) {
  assert(rows.size() == toSize(end - begin) * space_.rowFloats());
  tbb::parallel_for(begin, end, [&](int row) {
    const float* in = rows.data() + toSize(row - begin) * space_.rowFloats();
    for (int column = 0; column < space_.columns; ++column) {
      const std::size_t cell = space_.cell(row, column);
      for (int i = 0; i < space_.textures; ++i, in += space_.lanes()) {
        for (int n = 0; n < space_.expressions; ++n) values_[index(cell, i, n)] = Eigen::half(in[n]);
      }
    }
  });
}

void GridWeights::load(int begin, int end, std::span<float> rows) const {
  assert(rows.size() == toSize(end - begin) * space_.rowFloats());
  tbb::parallel_for(begin, end, [&](int row) {
    float* out = rows.data() + toSize(row - begin) * space_.rowFloats();
    for (int column = 0; column < space_.columns; ++column) {
      const std::size_t cell = space_.cell(row, column);
      for (int i = 0; i < space_.textures; ++i, out += space_.lanes()) {
        for (int n = 0; n < space_.expressions; ++n) out[n] = at(cell, i, n);
        std::fill(out + space_.expressions, out + space_.lanes(), 0.0f);
      }
    }
  });
}

std::pair<float, float> GridWeights::rangeOf(int texture, std::span<const std::uint8_t> used, Clipping clipping) const {
  std::vector<std::uint64_t> counts(std::size_t{1} << 16, 0);
  std::uint64_t total = 0;
  for (std::size_t cell = 0; cell < used.size(); ++cell) {
    if (used[cell] == 0) continue;
    for (int n = 0; n < space_.expressions; ++n) ++counts[keyOf(values_[index(cell, texture, n)])];
    total += static_cast<std::uint64_t>(space_.expressions);
  }
  if (total == 0) return {0.0f, 0.0f};
  const auto beyond = static_cast<std::uint64_t>(clipping.share * static_cast<double>(total));
  const auto lowest = [&counts](std::uint64_t count) {
    std::size_t key = 0;
    for (std::uint64_t seen = counts[key]; seen <= count; seen += counts[key]) ++key;
    return valueOf(static_cast<std::uint16_t>(key));
  };
  const auto highest = [&counts](std::uint64_t count) {
    std::size_t key = counts.size() - 1;
    for (std::uint64_t seen = counts[key]; seen <= count; seen += counts[key]) --key;
    return valueOf(static_cast<std::uint16_t>(key));
  };
  return {std::min(lowest(beyond), lowest(0) + clipping.most), std::max(highest(beyond), highest(0) - clipping.most)};
}

EncodedWeights GridWeights::encode(std::span<const std::uint8_t> used, Clipping clipping) const {
  assert(used.size() == space_.cellCount() && clipping.share >= 0.0 && clipping.share < 0.5);
  const auto textures = toSize(space_.textures);
  std::vector<std::pair<float, float>> ranges(textures);
  tbb::parallel_for(std::size_t{0}, textures,
                    [&](std::size_t i) { ranges[i] = rangeOf(static_cast<int>(i), used, clipping); });
  EncodedWeights encoded;
  std::vector<float> steps;  // codes per unit
  for (const auto& [low, high] : ranges) {
    const float scale = (high - low) / 255.0f;
    encoded.scale.push_back(static_cast<double>(scale));
    encoded.offset.push_back(static_cast<double>(low));
    steps.push_back(scale > 0.0f ? 1.0f / scale : 0.0f);
  }
  const std::size_t cells = space_.cellCount();
  encoded.codes.resize(cells * textures * toSize(space_.expressions));
  tbb::parallel_for(0, space_.expressions, [&](int n) {
    std::uint8_t* out = encoded.codes.data() + toSize(n) * cells * textures;
    for (std::size_t cell = 0; cell < cells; ++cell) {
      for (std::size_t i = 0; i < textures; ++i) {
        const float position = (at(cell, static_cast<int>(i), n) - static_cast<float>(encoded.offset[i])) * steps[i];
        *out++ = static_cast<std::uint8_t>(std::clamp(position, 0.0f, 255.0f) + 0.5f);
      }
    }
  });
  return encoded;
}

void decodeRows(const EncodedWeights& weights, const WeightSpace& space, int begin, int end, std::span<float> rows) {
  assert(rows.size() == toSize(end - begin) * space.rowFloats());
  const std::size_t cells = space.cellCount();
  const auto textures = toSize(space.textures);
  std::fill(rows.begin(), rows.end(), 0.0f);
  tbb::parallel_for(begin, end, [&](int row) {
    for (int n = 0; n < space.expressions; ++n) {
      float* out = rows.data() + toSize(row - begin) * space.rowFloats() + n;
      const std::uint8_t* code = weights.codes.data() + (toSize(n) * cells + space.cell(row, 0)) * textures;
      for (int column = 0; column < space.columns; ++column) {
        for (std::size_t i = 0; i < textures; ++i, out += space.lanes()) {
          *out = static_cast<float>(weights.scale[i]) * static_cast<float>(*code++) +
                 static_cast<float>(weights.offset[i]);
        }
      }
    }
  });
}

}  // namespace facezip::compress
