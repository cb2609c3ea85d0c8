// rig_weights.hpp - the weight maps of a rig's shapes, into a package that has those of the captured expressions.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "bands/map_set.hpp"
#include "face/face.hpp"
#include "facezip/capture.hpp"
#include "facezip/package.hpp"
#include "facezip/progress.hpp"
#include "rig/shape_codes.hpp"
#include "rig/skin_features.hpp"
#include "rig/texture_solve.hpp"

namespace facezip::rig {

/// What was chosen for the local solve, and how well it does.
struct ChosenSolve {
  TextureSolver solver;
  double left_out_rmse = 0.0;     ///< 1/255
  double left_out_nothing = 0.0;  ///< likewise, of predicting no change
};

/// Maps of a capture as a package blends them.
struct PackageMaps {
  compress::MapSet set;
  std::vector<compress::GridMap> maps;  ///< of the set, all of them

  const compress::GridMap& reference() const { return maps[set.reference]; }
};
PackageMaps openPackageMaps(const Capture& capture, const compress::Face& face, const Package& package);

/// The solver of textureSolveOf(options), not kStrain, with lambda and the share of strain from the options, or from
/// leaving captured expressions out.
ChosenSolve chooseSolve(const RigOptions& options, const Eigen::MatrixXd& weights, const SkinFeatures& features,
                        const PackageMaps& maps, Progress& progress);

/// Codes of a set of weights of a package, for the captured expressions and for the shapes.
/// map  one that the set is used by
using SolveSet = std::function<ShapeCodes(const Package& package, int set, const compress::GridMap& map)>;

/// Replaces the weights and the names of the package in `directory`: `captured` names, then those of the shapes, whose
/// weight maps `solve` finds. Atlas and package.json are written anew; textures
/// stay. Returns the share of the shapes' weights that was clamped, of the set that has most. Throws InputError,
/// OutputError, and what `solve` throws.
double addShapeWeights(const std::filesystem::path& directory, const std::vector<std::string>& captured,
                       const std::vector<std::string>& shapes, const SolveSet& solve, const PackageMaps& maps);

}  // namespace facezip::rig
