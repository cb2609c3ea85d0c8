// template_parts.hpp - parts behind a template's skin, as studios export them: eyes, and teeth with a texture.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>

#include "facezip/geometry/obj_io.hpp"
#include "small_capture.hpp"

namespace facezip::test {

inline constexpr int kBallRings = 8, kBallSegments = 12;

/// Appends to every OBJ file of a template two balls called "eyes", a fifth of the skin wide and below it, whose layout
/// has the front of the ball in the middle; and one triangle of "teeth", with the texture teeth.png of 4 x 4 texels
/// through the library parts.mtl. The files' shapes lift the eyes by 1 mm times (1 + the shape's place by name), the
/// teeth by nothing.
inline void appendParts(const std::filesystem::path& folder) {
  namespace fs = std::filesystem;
  const geometry::TriangleMesh neutral = geometry::readObj(folder / "neutral.obj");
  const Eigen::RowVector3d low = neutral.positions.colwise().minCoeff(), high = neutral.positions.colwise().maxCoeff();
  const double radius = 0.1 * (high - low)[0];
  int place = 0;
  for (const fs::path& file : geometry::objFiles(folder)) {
    const double lift = file.stem() == "neutral" ? 0.0 : 0.001 * ++place;
    std::string text = "\nmtllib parts.mtl\nusemtl eyes\n";
    for (const double side : {0.3, 0.7}) {
      const Eigen::RowVector3d centre(low[0] + side * (high - low)[0], 0.5 * (low[1] + high[1]),
                                      low[2] - radius + lift);
      int count = 0;
      for (int ring = 0; ring <= kBallRings; ++ring) {
        for (int segment = 0; segment < kBallSegments; ++segment, ++count) {
          const double a = std::numbers::pi * ring / kBallRings, b = 2 * std::numbers::pi * segment / kBallSegments;
          text += fmt::format("v {} {} {}\n", centre[0] + radius * std::sin(a) * std::cos(b),
                              centre[1] + radius * std::sin(a) * std::sin(b), centre[2] + radius * std::cos(a));
          text += fmt::format("vt {} {}\n", 0.5 + 0.5 * ring / kBallRings * std::cos(b),
                              0.5 + 0.5 * ring / kBallRings * std::sin(b));
        }
      }
      for (int ring = 0; ring < kBallRings; ++ring) {
        for (int segment = 0; segment < kBallSegments; ++segment) {
          const int next = (segment + 1) % kBallSegments;
          text += "f";
          for (const int corner : {ring * kBallSegments + segment, (ring + 1) * kBallSegments + segment,
                                   (ring + 1) * kBallSegments + next, ring * kBallSegments + next}) {
            text += fmt::format(" {0}/{0}", corner - count);
          }
          text += "\n";
        }
      }
    }
    text += fmt::format(
        "usemtl teeth\nv {0} {1} {2}\nv {3} {1} {2}\nv {0} {4} {2}\nvt 2.1 0.1\nvt 2.9 0.1\nvt 2.1 0.9\n"
        "f -3/-3 -2/-2 -1/-1\n",
        low[0], low[1], low[2] - radius, high[0], high[1]);
    std::ofstream(file, std::ios::app) << text;
  }
  std::ofstream(folder / "parts.mtl") << "newmtl teeth\nKd 0.8 0.8 0.8\nmap_Kd teeth.png\n";
  const image::ImageShape shape{4, 4, 3, image::SampleType::kUint8};
  image::writeImage(folder / "teeth.png", makeImage(shape, [](int x, int y, int c) { return 200.0 + x + y - c; }));
}

}  // namespace facezip::test
