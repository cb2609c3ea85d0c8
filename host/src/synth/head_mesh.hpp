// head_mesh.hpp - the mesh of a synthetic head: one chart with an outline and three holes.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "facezip/geometry/mesh.hpp"
#include "synth/head_shape.hpp"

namespace facezip::synth {

/// The holes. A hole is a slit along a grid row whose two lips are drawn apart, so that the rows around it follow
/// its border (edge loops, as an artist would lay them) and no triangle is cut.
enum Hole : std::size_t { kMouth, kLeftEye, kRightEye, kHoleCount };

/// How far a hole is open, as factors of its neutral height: 1 and 1 is neutral, a negative sum of lid heights closes
/// it.
struct Opening {
  double upper = 1.0;
  double lower = 1.0;
};
using Openings = std::array<Opening, kHoleCount>;

/// What a vertex is on the grid, before the slits are opened.
struct GridVertex {
  double s = 0.0;
  double t = 0.0;
  std::array<int, kHoleCount> side{};  ///< per hole: +1 above its slit, -1 below
  double lower_lip = 0.0;              ///< 0..1: how much the vertex follows the lower jaw; jumps only between the lips
};

/// A head in its neutral state.
struct HeadMesh {
  explicit HeadMesh(const HeadShape& shape);

  /// Where vertex `index` is on the skin when the holes are open as given.
  SkinPoint skinPoint(std::size_t index, const Openings& openings) const;

  std::vector<GridVertex> grid;
  geometry::TriangleMesh mesh;          ///< neutral; uv_triangles equals triangles
  std::vector<SkinPoint> skin;          ///< #V, skinPoint() of the neutral: what patterns are functions of
  std::vector<std::vector<int>> rings;  ///< #V, one-ring neighbours in rising order

  /// Side of the UV square in metres of skin.
  static constexpr double kUvExtent = 0.302;
};

/// Averages a per-vertex field over one-rings, `iterations` times; each spreads it by about one edge.
template <typename Field>
void smoothOverRings(const std::vector<std::vector<int>>& rings, int iterations, std::vector<Field>& field) {
  std::vector<Field> previous;
  for (int i = 0; i < iterations; ++i) {
    previous = field;
    for (std::size_t v = 0; v < field.size(); ++v) {
      Field sum = previous[v];
      for (const int neighbour : rings[v]) sum += previous[static_cast<std::size_t>(neighbour)];
      field[v] = sum / (1.0 + static_cast<double>(rings[v].size()));
    }
  }
}

}  // namespace facezip::synth
