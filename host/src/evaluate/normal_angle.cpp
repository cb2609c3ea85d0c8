#include "evaluate/normal_angle.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <cctype>
#include <cmath>
#include <numbers>

#include "bands/covered_texels.hpp"

namespace facezip::evaluate {
namespace {

constexpr double kShortest = 1e-6;

Eigen::Vector3d unitNormal(const float* texel) {
  const Eigen::Vector3d normal =
      (2.0 / 255.0) * Eigen::Map<const Eigen::Vector3f>(texel).cast<double>() - Eigen::Vector3d::Ones();
  const double length = normal.norm();
  return length < kShortest ? Eigen::Vector3d(0.0, 0.0, 1.0) : Eigen::Vector3d(normal / length);
}

}  // namespace

bool isNormalMap(const std::string& name, int channels) {
  std::string lower = name;
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return (channels == 3 || channels == 4) && lower.find("normal") != std::string::npos;
}

void normalAngles(std::span<const float> decoded, std::span<const float> captured, int channels,
                  std::span<const std::uint32_t> texels, std::span<float> angles) {
  assert(channels >= 3 && decoded.size() == captured.size() && angles.size() == texels.size());
  const auto stride = static_cast<std::size_t>(channels);
  compress::forEachChunk(texels.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Eigen::Vector3d a = unitNormal(decoded.data() + texels[i] * stride);
      const Eigen::Vector3d b = unitNormal(captured.data() + texels[i] * stride);
      // The arc cosine of the dot product would lose half the digits of small angles.
      const double radians = std::atan2(a.cross(b).norm(), a.dot(b));
      angles[i] = static_cast<float>(radians * 180.0 / std::numbers::pi);
    }
  });
}

NormalAngles summarizeNormalAngles(const ErrorDistribution& angles) {
  return {angles.mean(), angles.quantile(0.99), angles.max()};
}

}  // namespace facezip::evaluate
