// learn_library.hpp - a small library of people to learn from, each a patch with two bumps, and a stranger.
#pragma once

#include <filesystem>
#include <string>

#include "io/write_file.hpp"
#include "rig_capture.hpp"

namespace facezip::test {

inline constexpr const char* kLearnExpressions[] = {"left", "right", "upper", "all"};
inline const std::vector<std::vector<double>> kLearnAsked = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};

/// Wide people's bumps go further: 1 + 1.2 (width - 1).
inline double strengthOf(double width) { return 1.0 + 1.2 * (width - 1.0); }

inline geometry::TriangleMesh learnNeutral(double width) {
  geometry::TriangleMesh mesh = gridMesh(kRigSide);
  mesh.positions.col(0) *= width;
  mesh.positions.col(2) += 0.1 * (width - 1.0) * mesh.positions.col(1);
  return mesh;
}

/// A capture of a person of that width; `expressions` or the neutral alone. Skin is darker by 40 in the upper half
/// where a bump is at its highest.
inline void writeLearnSubject(const std::filesystem::path& folder, double width, bool expressions = true) {
  namespace fs = std::filesystem;
  fs::create_directories(folder / "expressions");
  fs::create_directories(folder / "albedo");
  const geometry::TriangleMesh neutral = learnNeutral(width);
  geometry::writeObj(folder / "neutral.obj", neutral);
  io::writeTextFile(folder / "capture.json", "{\"unit\": \"m\"}");
  const image::ImageShape shape{64, 64, 3, image::SampleType::kUint8};
  const auto base = [](int x, int y, int c) { return 110.0 + 10.0 * std::sin(0.4 * x + 0.3 * y + c); };
  image::writeImage(folder / "albedo/neutral.png", makeImage(shape, base));
  for (std::size_t e = 0; expressions && e < kLearnAsked.size(); ++e) {
    geometry::TriangleMesh mesh = neutral;
    for (int m = 0; m < 3; ++m) {
      mesh.positions += strengthOf(width) * kLearnAsked[e][static_cast<std::size_t>(m)] * templateShape(m);
    }
    geometry::writeObj(folder / "expressions" / (std::string(kLearnExpressions[e]) + ".obj"), mesh);
    const auto value = [&](int x, int y, int c) {
      double sum = base(x, y, c);
      for (int m = 0; m < 3; ++m) {
        const double u = ((x + 0.5) / 64 - 0.1) / 0.8, v = (1 - (y + 0.5) / 64 - 0.1) / 0.8;
        const double r = std::hypot(u - (m == 1 ? 0.7 : 0.3), v - (m == 2 ? 0.75 : 0.3)) / 0.22;
        if (r < 1) sum -= 40.0 * kLearnAsked[e][static_cast<std::size_t>(m)] * (1 - r) * (1 - r);
      }
      return sum;
    };
    image::writeImage(folder / "albedo" / (std::string(kLearnExpressions[e]) + ".png"), makeImage(shape, value));
  }
}

/// library/subjects/0, 1, ...; library/template; library/facs.json; stranger/: a neutral alone.
inline void writeLearnLibrary(const std::filesystem::path& folder, int subjects, double stranger_width = 1.1) {
  for (int s = 0; s < subjects; ++s) {
    writeLearnSubject(folder / "library/subjects" / std::to_string(s), 0.85 + 0.3 * s / std::max(1, subjects - 1));
  }
  const std::filesystem::path shapes = folder / "library/template";
  std::filesystem::create_directories(shapes);
  geometry::writeObj(shapes / "neutral.obj", learnNeutral(1.0));
  for (int m = 0; m < 3; ++m) {
    geometry::TriangleMesh mesh = learnNeutral(1.0);
    mesh.positions += templateShape(m);
    geometry::writeObj(shapes / (std::string(kRigShapes[m]) + ".obj"), mesh);
  }
  std::string facs = "{";
  for (std::size_t e = 0; e < kLearnAsked.size(); ++e) {
    facs += (e > 0 ? ",\"" : "\"") + std::string(kLearnExpressions[e]) + "\":{";
    bool first = true;
    for (std::size_t m = 0; m < 3; ++m) {
      if (kLearnAsked[e][m] == 0) continue;
      facs += (first ? "\"" : ",\"") + std::string(kRigShapes[m]) + "\":1";
      first = false;
    }
    facs += "}";
  }
  io::writeTextFile(folder / "library/facs.json", facs + "}");
  writeLearnSubject(folder / "stranger", stranger_width, /* expressions= */ false);
}

}  // namespace facezip::test
