// rig_capture.hpp - a small capture with meshes and textures that follow two shapes, and the template of another patch.
#pragma once

#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "small_capture.hpp"

namespace facezip::test {

/// Displacement of shape m (0, 1, 2) of a patch of `side` x `side` vertices: a bump in a corner of its own, out of the
/// patch and along it; `size` in metres.
inline Eigen::MatrixX3d rigShape(int side, int m, double size) {
  Eigen::MatrixX3d moved = Eigen::MatrixX3d::Zero(side * side, 3);
  const double cx = m == 1 ? 0.7 : 0.3, cy = m == 2 ? 0.75 : 0.3;
  for (int v = 0; v < side * side; ++v) {
    const double x = static_cast<double>(v % side) / (side - 1), y = static_cast<double>(v / side) / (side - 1);
    const double r = std::hypot(x - cx, y - cy) / 0.22;
    if (r < 1) moved.row(v) << size * (cx - x) * (1 - r), 0.3 * size * (1 - r), size * (1 - r) * (1 - r);
  }
  return moved;
}

inline constexpr int kRigSide = 21;
/// The template's: as strong, but along the patch the skin goes elsewhere.
inline Eigen::MatrixX3d templateShape(int m) {
  return rigShape(kRigSide, m, 0.03) * Eigen::Vector3d(-0.5, 1.6, 1.0).asDiagonal();
}

inline const std::vector<std::vector<double>> kRigWeights = {
    {1.0, 0.0, 0.0}, {0.0, 0.8, 0.3}, {0.6, 0.5, 0.0}, {0.0, 0.2, 0.9}};
inline const char* const kRigShapes[] = {"bumpA", "bumpB", "bumpC"};

/// capture/: neutral, four expressions r0 to r3 of kRigWeights, whose albedo brightens with the shapes; template/: the
/// shapes on a wider patch. Texture of shape m alone: 60 (1 - r)^2 where it moves.
inline void writeRigCapture(const std::filesystem::path& folder) {
  namespace fs = std::filesystem;
  fs::create_directories(folder / "capture/expressions");
  fs::create_directories(folder / "capture/albedo");
  fs::create_directories(folder / "template");
  const geometry::TriangleMesh neutral = gridMesh(kRigSide);
  geometry::writeObj(folder / "capture/neutral.obj", neutral);
  const image::ImageShape shape{64, 64, 3, image::SampleType::kUint8};
  const auto base = [](int x, int y, int c) { return 90.0 + 10.0 * std::sin(0.4 * x + 0.3 * y + c); };
  image::writeImage(folder / "capture/albedo/neutral.png", makeImage(shape, base));
  for (std::size_t n = 0; n < kRigWeights.size(); ++n) {
    const std::string name = "r" + std::to_string(n);
    geometry::TriangleMesh mesh = neutral;
    for (int m = 0; m < 3; ++m) {
      mesh.positions += kRigWeights[n][static_cast<std::size_t>(m)] * rigShape(kRigSide, m, 0.03);
    }
    geometry::writeObj(folder / "capture/expressions" / (name + ".obj"), mesh);
    const auto value = [&](int x, int y, int c) {
      double sum = base(x, y, c);
      for (int m = 0; m < 3; ++m) {
        const double u = ((x + 0.5) / 64 - 0.1) / 0.8, v = (1 - (y + 0.5) / 64 - 0.1) / 0.8;
        const double r = std::hypot(u - (m == 1 ? 0.7 : 0.3), v - (m == 2 ? 0.75 : 0.3)) / 0.22;
        if (r < 1) sum += 60.0 * kRigWeights[n][static_cast<std::size_t>(m)] * (1 - r) * (1 - r);
      }
      return sum;
    };
    image::writeImage(folder / "capture/albedo" / (name + ".png"), makeImage(shape, value));
  }
  geometry::TriangleMesh other = neutral;
  other.positions.col(0) *= 1.15;
  geometry::writeObj(folder / "template/neutral.obj", other);
  for (int m = 0; m < 3; ++m) {
    geometry::TriangleMesh mesh = other;
    mesh.positions += templateShape(m);
    geometry::writeObj(folder / "template" / (std::string(kRigShapes[m]) + ".obj"), mesh);
  }
}

}  // namespace facezip::test
