// refinement.hpp - weights freed from the masks: difference textures and grid weights fitted in turn.
//   minimise  sum_maps metric sum_p t(p) (sum_n |Delta_n(p) - D(p)^T w_n(p)|^2 + ridge |D(p)|^2)
//             + smoothness sum_{q ~ q'} |W(q) - W(q')|^2 + trust sum_q |W(q) - start(q)|^2
// over D (difference_fit.hpp) and W (weight_system.hpp) by turns, starting from the paper's weights (FaceZip, Eq. 6). A
// cell touches only the texels up to the next cells' centres, so the turns are taken window by window: one pass over
// the texels serves all sweeps, and memory does not grow with the height of the image. Rows of cells above the window
// are done and stay, those below are still where they started. The sweeps are made on half cells where those fit
// (half_cells.hpp), with one more turn on the texels; every step on texels lowers the objective of the whole image.
#pragma once

#include <span>
#include <vector>

#include "bands/map_set.hpp"
#include "bands/tile_band.hpp"
#include "device/device_context.hpp"
#include "facezip/progress.hpp"
#include "refine/grid_weights.hpp"
#include "refine/map_window.hpp"
#include "refine/texture_encoding.hpp"

namespace facezip::compress {

struct RefinementOptions {
  int most_sweeps = 6;       ///< of a window; 0 fits difference textures to the start's weights and leaves those alone
  double least_gain = 0.01;  ///< a window is done when a sweep lowers its squared error by less than this share
  int relax_sweeps = 3;      ///< block Gauss-Seidel sweeps over the weights in a turn
  double smoothness = 3e-4;  ///< of RefinementProblem::cell_energy
  double trust = 1e-4;       ///< likewise
  double ridge = 1e-4;       ///< per expression and 1 / C, the mean square of a weight
  double clipped_tiles = 0.005;  ///< share of the tiles that may reach beyond the difference textures' codes at an end
  double most_clipped = 16.0;    ///< by how much that may change a frame, in 1/255: more shows as a smear
};

/// What is refined. References must outlive the call.
struct RefinementProblem {
  WeightSpace space;
  const EncodedWeights& start;    ///< the paper's weights
  std::span<const GridMap> maps;  ///< that share the weights
  MakeMapTiles make_tiles;
  double cell_energy = 0.0;  ///< mean of sum_p t |Delta_n|^2 over the covered cells and expressions; above 0
  int window_rows = 0;       ///< rows of cells that a window frees: windowRowStep() times a whole number
};

struct Refinement {
  explicit Refinement(const WeightSpace& space) : weights(space) {}
  GridWeights weights;
  /// Of every map: reach of the difference textures that suit `weights`, entry texture * channels + channel.
  std::vector<std::vector<TextureRange>> ranges;
  std::vector<double> errors;      ///< squared error, texel and metric weights in it, at the start and after each sweep
  std::vector<double> end_errors;  ///< of every map: plain squared error with `weights`, before anything is rounded
};

/// Refines. Throws DeviceError, InputError, OutputError, Cancelled.
Refinement refine(device::DeviceContext& context, const RefinementProblem& problem, const RefinementOptions& options,
                  Progress& progress);

/// True if the sweeps are made on half cells (half_cells.hpp) rather than texels: where they fit all maps' weight
/// scales, on CPUs.
bool sweepsHalfCells(const device::DeviceContext& context, std::span<const GridMap> maps);

/// The ridge of difference_fit for N expressions and C textures.
float ridgeOf(const RefinementOptions& options, const WeightSpace& space);

/// Windows begin and end at multiples of this many rows of cells, so that they do at whole tiles of every map.
int windowRowStep(std::span<const GridMap> maps);

}  // namespace facezip::compress
