// search_stage.hpp - weights before any fit: clusters of every mask and their place in the textures (FaceZip, Eq. 2 to
// 6), or the influences of compress and stretch maps.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "device/run.hpp"
#include "face/face.hpp"
#include "facezip/compress.hpp"
#include "raster/uv_raster.hpp"
#include "refine/grid_weights.hpp"
#include "search/difference_texture.hpp"
#include "search/gram_matrices.hpp"
#include "search/weight_map.hpp"

namespace facezip::compress {

/// How the permutation was found, for reports.
struct PermutationRecord {
  double cost = 0.0;            ///< Eq. 3
  std::string solver;           ///< "descent" or "message-passing"; "" if not permuted
  std::optional<double> bound;  ///< lower bound of every permutation's cost
  std::vector<double> bounds;   ///< pairs of masks alone, then after each iteration of message passing
  double median_restart_cost = 0.0;
  std::vector<double> restart_costs;
  std::vector<std::vector<double>> convergence;  ///< cost after each sweep, per restart
};

struct SearchedWeights {
  EncodedWeights weights;            ///< Eq. 6, or normalised influences
  TextureCoefficients coefficients;  ///< Eq. 5; empty for influences
  PermutationRecord permutation;
};

/// Clusters the fragments, permutes the clusters and lays the weight maps that follow. Touches no texel.
/// cells  masks at the cells of the weight grid
/// Throws DeviceError, Cancelled.
SearchedWeights searchWeights(const GramMatrices& grams, const CellMasks& cells, const CompressOptions& options,
                              int differences, const device::Run& run);

/// The weights of compress and stretch maps (Li et al. 2020, Eq. 10 to 12): they follow from the meshes alone.
/// raster  of the largest map, with `weight_scale` texels to a cell
/// Throws InputError: an expression without mesh.
SearchedWeights influenceWeights(const Capture& capture, const Face& face, const raster::UvRaster& raster,
                                 int weight_scale, const device::Run& run);

}  // namespace facezip::compress
