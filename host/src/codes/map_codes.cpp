#include "codes/map_codes.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace facezip::compress {
namespace {

/// The code nearest to `code` that blocks of one colour have exactly: BC1's ends have 5, 6 and 5 bits; BC7's have 7 and
/// share the eighth. Others have all.
double exactCode(BlockFormat format, std::size_t channel, double code) {
  if (format == BlockFormat::kBc7) return 2.0 * std::min(std::round(code / 2.0), 127.0);
  if (format != BlockFormat::kBc1) return code;
  const int bits = channel == 1 ? 6 : 5;
  const int end = static_cast<int>(std::round(code / 255.0 * ((1 << bits) - 1)));
  return end << (8 - bits) | end >> (2 * bits - 8);
}

}  // namespace

MapCodes codesOfBlocks(std::span<const TextureRange> ranges, BlockFormat format, int textures) {
  MapCodes codes = codesOfBits(ranges, 8);
  const std::size_t channels = ranges.size() / static_cast<std::size_t>(textures);
  for (std::size_t plane = 0; plane < ranges.size(); ++plane) {
    TextureEncoding& encoding = codes.encoding[plane];
    if (encoding.scale == 0.0f) continue;
    const double zero = std::round(-encoding.offset / encoding.scale);
    encoding = encodingAround(ranges[plane], exactCode(format, plane % channels, zero));
  }
  codes.formats.assign(static_cast<std::size_t>(textures), format);
  return codes;
}

MapCodes codesOfBits(std::span<const TextureRange> ranges, int bits) {
  MapCodes codes{bits, {}};
  for (const TextureRange& range : ranges) codes.encoding.push_back(encodingFor(range, bits));
  return codes;
}

std::vector<double> meanSquares(const EncodedWeights& weights, const WeightSpace& space,
                                std::span<const std::uint8_t> used) {
  const auto textures = static_cast<std::size_t>(space.textures);
  std::vector<double> sums(textures, 0.0);
  std::uint64_t count = 0;
  for (std::size_t n = 0; n < static_cast<std::size_t>(space.expressions); ++n) {
    for (std::size_t cell = 0; cell < used.size(); ++cell) {
      if (used[cell] == 0) continue;
      ++count;
      const std::uint8_t* code = weights.codes.data() + (n * used.size() + cell) * textures;
      for (std::size_t i = 0; i < textures; ++i) {
        const double value = weights.scale[i] * code[i] + weights.offset[i];
        sums[i] += value * value;
      }
    }
  }
  for (double& sum : sums) sum = count > 0 ? sum / static_cast<double>(count) : 0.0;
  return sums;
}

double codeSquaredError(std::span<const TextureRange> ranges, std::span<const double> weight_squares) {
  const std::size_t channels = ranges.size() / weight_squares.size();
  assert(channels * weight_squares.size() == ranges.size());
  double error = 0.0;
  for (std::size_t plane = 0; plane < ranges.size(); ++plane) {
    const double step = static_cast<double>(encodingFor(ranges[plane], 8).scale);
    error += step * step / 12.0 * weight_squares[plane / channels];
  }
  return error;
}

int codeBits(double code_error, double error) { return code_error > 0.05 * error ? 16 : 8; }

}  // namespace facezip::compress
