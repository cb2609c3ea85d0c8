// coded_refinement.hpp - weights that suit what blocks decode to. Difference textures are coded one after the other
// (coded_textures.hpp), and the weights of every cell are then fitted to the decoded ones, by turns, window by window
// as in refinement.hpp and with its objective.
#pragma once

#include <span>
#include <vector>

#include "codes/coded_neutral.hpp"
#include "codes/coded_textures.hpp"
#include "refine/grid_weights.hpp"
#include "refine/refinement.hpp"

namespace facezip::compress {

/// A map and how it is coded; one that is kept as images has no neutral, and its textures are not rounded.
struct CodedMap {
  GridMap map;
  TextureCoding coding;
  const CodedNeutral* neutral = nullptr;
};

/// References must outlive the call.
struct CodedProblem {
  WeightSpace space;
  const EncodedWeights& start;     ///< fitted to textures that are not coded; trust is to them
  std::span<const CodedMap> maps;  ///< that share the weights
  MakeMapTiles make_tiles;
  double cell_energy = 0.0;  ///< as RefinementProblem has it
  int window_rows = 0;       ///< rows of cells
};

/// Fits the weights in `turns` turns of textures and weights. Throws DeviceError, InputError, OutputError, Cancelled.
GridWeights refineCoded(device::DeviceContext& context, const CodedProblem& problem, const RefinementOptions& options,
                        int turns, Progress& progress);

}  // namespace facezip::compress
