// fit_stage.hpp - pass 2: the weights that are written, and how far the difference textures reach that go with them.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "bands/map_set.hpp"
#include "codes/coded_neutral.hpp"
#include "compress/texture_source.hpp"
#include "device/run.hpp"
#include "face/importance.hpp"
#include "refine/grid_weights.hpp"
#include "refine/map_window.hpp"
#include "refine/texture_encoding.hpp"

namespace facezip::compress {

/// A set of weights as it is written, with what is known of the difference textures of the maps that share it.
struct FittedWeights {
  EncodedWeights weights;
  std::vector<std::vector<TextureRange>> ranges;  ///< of every map's difference textures, C x channels
  /// Of every map: squared error before anything is rounded, in (1/255)^2. Empty where textures were not fitted.
  std::vector<double> errors;
  /// Squared error of all maps, texel and fit weights in it, at the start and after each sweep.
  std::vector<double> sweep_errors;
  /// Of every map: its neutral in blocks; none for maps that are kept as images. Empty where all are.
  std::vector<std::optional<CodedNeutral>> neutrals;
};

/// What is fitted. References outlive the call.
struct FitProblem {
  WeightSpace space;
  std::span<const GridMap> maps;          ///< that share the weights
  const EncodedWeights& start;            ///< the search's
  double energy = 0.0;                    ///< of all differences: trace of their Gram matrix
  std::span<const std::uint8_t> covered;  ///< of every cell of the grid: 1 if it has a covered texel
  const std::optional<Importance>& importance;
  int window_rows = 0;     ///< rows of cells that a window frees
  bool in_blocks = false;  ///< textures become blocks, which are fitted to each other
};

/// Weights and difference textures fitted in turn.
/// most_sweeps  0: the start's weights, and the textures that suit them
/// Throws DeviceError, InputError, Cancelled.
FittedWeights fitWeights(const FitProblem& problem, int most_sweeps, const device::Run& run);

/// Mean energy of an expression's differences on a covered cell: what smoothness and trust are measured by.
double cellEnergy(const FitProblem& problem);

/// Tiles of a map that a fit looks at, with importance in their texel weights.
MakeMapTiles weighedTiles(const FitProblem& problem);

/// Bytes of fitted weights, as packages hold them.
EncodedWeights encodeFitted(const GridWeights& weights, const FitProblem& problem);

/// The weights as they are, with textures that follow from them (the paper's method): a pass finds how far those reach.
/// textures  of the maps' weights
FittedWeights keepWeights(const EncodedWeights& weights, std::span<const GridMap> maps, int differences,
                          TextureSource& textures, int band_rows, const device::Run& run);

}  // namespace facezip::compress
