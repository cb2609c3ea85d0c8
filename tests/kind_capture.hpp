// kind_capture.hpp - captures whose differences a test gives as a function of texel, channel and expression.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <ostream>
#include <string>

#include "small_capture.hpp"

namespace facezip::test {

/// A capture of one map from a function of texel, channel and expression, in units of 1/255.
struct Kind {
  std::string name;
  int expressions = 6;
  int width = 80;
  int height = 80;
  image::SampleType type = image::SampleType::kUint8;
  std::function<double(int x, int y, int c, int n)> difference;
};

inline void PrintTo(const Kind& kind, std::ostream* out) { *out << kind.name; }

/// From -1 to 1, the same in every run.
inline double noise(int x, int y, int c, int n) {
  const auto u = [](int value) { return static_cast<std::uint32_t>(value); };
  std::uint32_t h = (u(x) * 73856093u ^ u(y) * 19349663u ^ u(c) * 83492791u ^ u(n + 1) * 2654435u) * 2654435761u;
  h ^= h >> 15;
  h *= 2246822519u;
  h ^= h >> 13;
  return static_cast<double>(h % 2001) / 1000.0 - 1.0;
}

/// 1 at the centre.
inline double spot(double x, double y, double centre_x, double centre_y, double radius) {
  return std::exp(-((x - centre_x) * (x - centre_x) + (y - centre_y) * (y - centre_y)) / (radius * radius));
}

/// Stripes in a place and direction of the expression's own, and a little noise.
inline double wrinkles(int x, int y, int c, int n) {
  const double stripes = std::sin(0.4 * x * std::cos(0.7 * n) + 0.4 * y * std::sin(0.7 * n));
  return (40.0 - 8.0 * c) * stripes * spot(x, y, 16.0 + 11.0 * (n % 6), 20.0 + 17.0 * (n % 4), 22.0) +
         2.0 * noise(x, y, c, n);
}

/// Writes the capture, or adds a map to one that is there.
inline void writeCapture(const std::filesystem::path& folder, const Kind& kind, const std::string& map = "albedo") {
  std::filesystem::create_directories(folder / map);
  geometry::writeObj(folder / "neutral.obj", gridMesh(21));
  const image::ImageShape shape{kind.width, kind.height, 3, kind.type};
  const std::string extension = kind.type == image::SampleType::kFloat32 ? ".exr" : ".png";
  const auto neutral = [](int x, int y, int c) { return 120.0 + 10.0 * std::sin(0.3 * x + 0.2 * y + c); };
  image::writeImage(folder / map / ("neutral" + extension), makeImage(shape, neutral));
  for (int n = 0; n < kind.expressions; ++n) {
    const auto expression = [&](int x, int y, int c) {
      const double value = neutral(x, y, c) + kind.difference(x, y, c, n);
      return kind.type == image::SampleType::kFloat32 ? value : std::clamp(value, 0.0, 255.0);
    };
    image::writeImage(folder / map / (smallExpressionName(n) + extension), makeImage(shape, expression));
  }
}

}  // namespace facezip::test
