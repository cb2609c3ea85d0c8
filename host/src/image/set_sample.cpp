#include "image/set_sample.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

namespace facezip::image {

void setSample(Image& image, std::size_t index, float value) {
  std::byte* at = image.samples.data() + index * sampleBytes(image.shape.type);
  const auto write = [at](auto stored) { std::memcpy(at, &stored, sizeof(stored)); };
  const auto code = [&] {
    const float full = 255.0f / unit255(image.shape.type);
    return std::lround(std::clamp(value * full, 0.0f, full));
  };
  switch (image.shape.type) {
    case SampleType::kUint8:
      return write(static_cast<std::uint8_t>(code()));
    case SampleType::kUint16:
      return write(static_cast<std::uint16_t>(code()));
    case SampleType::kFloat32:
      return write(value);
  }
}

}  // namespace facezip::image
