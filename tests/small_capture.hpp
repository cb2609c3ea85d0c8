// small_capture.hpp - captures of a few texels that tests write, and break, themselves.
#pragma once

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "facezip/geometry/mesh.hpp"
#include "facezip/geometry/obj_io.hpp"
#include "image/image_file.hpp"

namespace facezip::test {

/// A square patch of `side` x `side` vertices, 0.2 m wide, whose UVs fill [margin, 1 - margin]^2.
inline geometry::TriangleMesh gridMesh(int side, double margin = 0.1) {
  geometry::TriangleMesh mesh;
  mesh.positions.resize(side * side, 3);
  mesh.uvs.resize(side * side, 2);
  mesh.triangles.resize(2 * (side - 1) * (side - 1), 3);
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      const double s = static_cast<double>(x) / (side - 1);
      const double t = static_cast<double>(y) / (side - 1);
      mesh.positions.row(y * side + x) << 0.2 * s, 0.25 * t, 0.02 * std::sin(3.0 * s);
      mesh.uvs.row(y * side + x) << margin + (1 - 2 * margin) * s, margin + (1 - 2 * margin) * t;
    }
  }
  int triangle = 0;
  for (int y = 0; y + 1 < side; ++y) {
    for (int x = 0; x + 1 < side; ++x) {
      const int v = y * side + x;
      mesh.triangles.row(triangle++) << v, v + 1, v + side + 1;
      mesh.triangles.row(triangle++) << v, v + side + 1, v + side;
    }
  }
  mesh.uv_triangles = mesh.triangles;
  return mesh;
}

/// An image whose samples are `value(x, y, channel)` in units of 1/255, in any sample type.
template <typename Function>
image::Image makeImage(const image::ImageShape& shape, const Function& value) {
  image::Image image{shape, {}};
  image.samples.resize(static_cast<std::size_t>(shape.height) * shape.rowBytes());
  std::size_t i = 0;
  for (int y = 0; y < shape.height; ++y) {
    for (int x = 0; x < shape.width; ++x) {
      for (int c = 0; c < shape.channels; ++c, ++i) {
        const double v = value(x, y, c);
        if (shape.type == image::SampleType::kUint8) {
          reinterpret_cast<std::uint8_t*>(image.samples.data())[i] = static_cast<std::uint8_t>(std::lround(v));
        } else if (shape.type == image::SampleType::kUint16) {
          reinterpret_cast<std::uint16_t*>(image.samples.data())[i] =
              static_cast<std::uint16_t>(std::lround(v * 257.0));
        } else {
          reinterpret_cast<float*>(image.samples.data())[i] = static_cast<float>(v / 255.0);
        }
      }
    }
  }
  return image;
}

struct SmallCaptureOptions {
  int expressions = 6;
  int width = 80;
  int height = 80;
  int channels = 3;
  image::SampleType type = image::SampleType::kUint8;
  std::string extension = "png";
  std::vector<std::string> maps = {"albedo"};
  int distinct = 1000;  ///< expressions n and n + distinct have the same textures
};

/// Names of the expressions that writeSmallCapture() makes: e00, e01, ...
inline std::string smallExpressionName(int n) { return (n < 10 ? "e0" : "e") + std::to_string(n); }

/// Writes a capture of a patch whose expressions brighten a spot each, over a textured neutral.
inline void writeSmallCapture(const std::filesystem::path& folder, const SmallCaptureOptions& options = {}) {
  namespace fs = std::filesystem;
  fs::create_directories(folder);
  geometry::writeObj(folder / "neutral.obj", gridMesh(21));
  const image::ImageShape shape{options.width, options.height, options.channels, options.type};
  for (const std::string& map : options.maps) {
    fs::create_directories(folder / map);
    const auto neutral = [](int x, int y, int c) { return 100.0 + 20.0 * std::sin(0.3 * x + 0.2 * y + c); };
    image::writeImage(folder / map / ("neutral." + options.extension), makeImage(shape, neutral));
    for (int n = 0; n < options.expressions; ++n) {
      const int kind = n % options.distinct;
      const double centre_x = options.width * (0.2 + 0.6 * std::fmod(0.37 * kind, 1.0));
      const double centre_y = options.height * (0.2 + 0.6 * std::fmod(0.61 * kind, 1.0));
      const auto expression = [&](int x, int y, int c) {
        const double distance2 = (x - centre_x) * (x - centre_x) + (y - centre_y) * (y - centre_y);
        const double radius = 0.15 * options.width;
        return neutral(x, y, c) + (30.0 + 10.0 * (kind % 3) - 15.0 * c) * std::exp(-distance2 / (radius * radius));
      };
      image::writeImage(folder / map / (smallExpressionName(n) + "." + options.extension),
                        makeImage(shape, expression));
    }
  }
}

}  // namespace facezip::test
