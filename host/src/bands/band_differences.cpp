#include "bands/band_differences.hpp"

#include "io/counts.hpp"

namespace facezip::compress {
namespace {

template <typename Sample>
void gather(std::span<const std::byte> samples, const BandShape& shape, std::span<const std::uint32_t> texels,
            Eigen::MatrixXf& differences) {
  const auto* neutral = reinterpret_cast<const Sample*>(samples.data());
  const auto channels = toSize(shape.channels);
  const std::size_t image = toSize(shape.rows, shape.width) * channels;
  const float unit = image::unit255(shape.sample_type);
  for (int n = 0; n < shape.expressions; ++n) {
    const Sample* expression = neutral + toSize(n + 1) * image;
    float* out = differences.col(n).data();
    for (const std::uint32_t texel : texels) {
      for (std::size_t at = texel * channels; at < (texel + std::size_t{1}) * channels; ++at) {
        *out++ = unit * (static_cast<float>(expression[at]) - static_cast<float>(neutral[at]));
      }
    }
  }
}

}  // namespace

Eigen::MatrixXf gatherDifferences(std::span<const std::byte> samples, const BandShape& shape,
                                  std::span<const std::uint32_t> texels) {
  Eigen::MatrixXf differences(static_cast<Eigen::Index>(texels.size()) * shape.channels, shape.expressions);
  switch (shape.sample_type) {
    case image::SampleType::kUint8:
      gather<std::uint8_t>(samples, shape, texels, differences);
      break;
    case image::SampleType::kUint16:
      gather<std::uint16_t>(samples, shape, texels, differences);
      break;
    case image::SampleType::kFloat32:
      gather<float>(samples, shape, texels, differences);
      break;
  }
  return differences;
}

}  // namespace facezip::compress
