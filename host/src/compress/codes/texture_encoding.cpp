#include "compress/codes/texture_encoding.hpp"

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

}  // namespace facezip::compress
