// skin_state.hpp - what a deformation does to the skin, per vertex: creases, blood, occlusion.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "synth/head_mesh.hpp"

namespace facezip::synth {

/// State of the skin at a vertex of one expression. Interpolated linearly over triangles.
struct SkinState {
  /// Strongest compression c = 1 - (length after / length before), >= 0, as c (cos 2a, sin 2a), where a is the angle of
  /// its direction to the s axis: doubled, so that opposite directions are one and the average of many makes sense.
  float compression_x = 0.0f, compression_y = 0.0f;
  float log_area = 0.0f;      ///< log(area after / area before), spread over about a centimetre
  float openness = 1.0f;      ///< ambient light that arrives, 0..1
  float metres_per_u = 1.0f;  ///< length on this mesh of one unit of u and v: slopes need it
  float metres_per_v = 1.0f;
};

/// Ambient light per vertex, 0..1, from the disks that stand for the other vertices within 25 mm (Bunnell 2005). An
/// approximation by design: no rays, no shadowing of one disk by another, nothing behind the skin (teeth, eyeballs).
std::vector<double> ambientOpenness(const Eigen::MatrixX3d& positions, const Eigen::MatrixX3i& triangles);

/// State of every vertex when `neutral.mesh` is deformed to `positions` (#V by 3).
std::vector<SkinState> skinStates(const HeadMesh& neutral, const Eigen::MatrixX3d& positions);

}  // namespace facezip::synth
