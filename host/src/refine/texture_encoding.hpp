// texture_encoding.hpp - the scale and offset with which a difference texture is kept as integer codes.
#pragma once

namespace facezip::compress {

/// Smallest and largest value, in units of 1/255; min > max where there was no texel.
struct TextureRange {
  float min = 0.0f;
  float max = 0.0f;
};

/// value = scale * code + offset, in units of 1/255; scale 0 or more.
struct TextureEncoding {
  float scale = 1.0f;
  float offset = 0.0f;
};

/// Scale and offset that hold `range`, widened to reach 0, in codes of `bits` bits. Zero is one of the codes, and its
/// code gives 0 exactly in float arithmetic, fused or not: an untouched texel stays untouched on every device.
/// No end of the range is missed by more than half a step. An empty range, or one of 0 alone, gives {0, 0}.
/// bits  8 or 16
TextureEncoding encodingFor(const TextureRange& range, int bits);

/// The same in 8 bits with a zero that is given, a whole code from 0 to 255: the smallest scale that holds the range.
TextureEncoding encodingAround(const TextureRange& range, double zero_code);

}  // namespace facezip::compress
