// cell_samples.hpp - a point of the surface for every cell of a weight grid.
#pragma once

#include <vector>

#include "raster/uv_raster.hpp"

namespace facezip::raster {

/// The covered texel nearest to the centre of each cell of a weight grid, row-major; kEmpty where a cell has none.
/// scale  texels per cell and axis
std::vector<TexelSample> cellSamples(const UvRaster& raster, int scale);

/// For every cell the nearest one (in steps along the grid) that has a sample; -1 for all where none has.
std::vector<int> nearestSampled(const std::vector<TexelSample>& cells, int columns, int rows);

}  // namespace facezip::raster
