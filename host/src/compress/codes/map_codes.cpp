#include "compress/codes/map_codes.hpp"

#include <cassert>

namespace facezip::compress {

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
