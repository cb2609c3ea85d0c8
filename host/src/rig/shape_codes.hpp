// shape_codes.hpp - weight maps of captured expressions and of a rig's shapes, in codes that suit both.
#pragma once

#include <cstddef>
#include <vector>

#include "bands/map_set.hpp"
#include "facezip/package.hpp"
#include "facezip/progress.hpp"
#include "rig/skin_features.hpp"
#include "rig/texture_solve.hpp"

namespace facezip::rig {

/// A set of weights: those of its expressions, then of the shapes. W = scale[i] * code + offset[i].
struct ShapeCodes {
  std::vector<double> scale;     ///< C
  std::vector<double> offset;    ///< C
  std::vector<std::byte> codes;  ///< [N + M][cell][C]
  double clamped = 0.0;          ///< share of the shapes' weights on the face that the codes do not reach
};

/// A set of weights as the package has it, [cell][C] by expression: column n is expression n. Throws InputError.
Eigen::MatrixXf decodeSet(const Package& package, int set);

/// Solves the weight maps of the shapes in a set of `package`, which has those of the captured expressions. The codes
/// are the captured ones', but where shapes go farther they reach up to twice as far (five times with the
/// pseudo-inverse, then for every weight): a range that held whatever a bad solution makes would coarsen what was
/// captured. map  one that the set is used by. Throws InputError, Cancelled.
ShapeCodes solveShapes(const Package& package, int set, const TextureSolver& solver, const SkinFeatures& features,
                       const compress::GridMap& map, Progress& progress);

}  // namespace facezip::rig
