#include "refine/texture_encoding.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace facezip::compress {
namespace {

/// The smallest float of `digits` significant binary digits that is not below `value`, which is positive.
float roundUpToDigits(double value, int digits) {
  int exponent = 0;
  const double fraction = std::frexp(value, &exponent);
  return static_cast<float>(std::ldexp(std::ceil(std::ldexp(fraction, digits)), exponent - digits));
}

}  // namespace

TextureEncoding encodingFor(const TextureRange& range, int bits) {
  assert(bits == 8 || bits == 16);
  const double low = std::min(range.min, 0.0f);
  const double high = std::max(range.max, 0.0f);
  const double codes = std::ldexp(1.0, bits) - 1.0;
  // Below the smallest normal float there is nothing to see, and a scale would lose its digits.
  if (!((high - low) / codes >= std::numeric_limits<float>::min())) return {0.0f, 0.0f};
  // scale * code is exact where the digits of both fit a float's 24.
  const float scale = roundUpToDigits((high - low) / codes, std::numeric_limits<float>::digits - bits);
  const float zero_code = static_cast<float>(std::round(-low / static_cast<double>(scale)));
  return {scale, -scale * zero_code};
}

TextureEncoding encodingAround(const TextureRange& range, double zero_code) {
  assert(zero_code >= 0.0 && zero_code <= 255.0);
  // Where zero is the first or the last code, what lies beyond it is clamped: a scale for it would be infinite.
  const double above = zero_code < 255.0 ? std::max(range.max, 0.0f) / (255.0 - zero_code) : 0.0;
  const double below = zero_code > 0.0 ? -std::min(range.min, 0.0f) / zero_code : 0.0;
  const double step = std::max(above, below);
  if (!(step >= std::numeric_limits<float>::min())) return {0.0f, 0.0f};
  const float scale = roundUpToDigits(step, std::numeric_limits<float>::digits - 8);
  return {scale, -scale * static_cast<float>(zero_code)};
}

}  // namespace facezip::compress
