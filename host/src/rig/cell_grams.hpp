// cell_grams.hpp - inner products of the captured differences in some cells of the weight grid.
#pragma once

#include <span>
#include <vector>

#include "bands/map_set.hpp"
#include "facezip/progress.hpp"
#include "rig/texture_solve.hpp"

namespace facezip::rig {

/// Cells with their Gram matrices, summed over all maps by their fit weights; at most `most` of them, evenly spread
/// over those that have a sample. One pass over the textures.
/// samples  of the cells of the grid: raster::cellSamples()
/// covered_samples  receives the number of covered texels times channels and weights that the cells have in all
std::vector<SolvedCell> gatherCells(std::span<const compress::GridMap> maps, const SkinFeatures& features,
                                    const std::vector<raster::TexelSample>& samples, int columns, std::size_t most,
                                    double& covered_samples, Progress& progress);

}  // namespace facezip::rig
