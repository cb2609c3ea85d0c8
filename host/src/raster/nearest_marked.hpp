// nearest_marked.hpp - whom the cells of a grid without content of their own copy.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace facezip::raster {

/// For every cell of a columns x rows grid, row-major, the nearest cell (in steps along the grid, ties to the one found
/// first in row-major order) that is marked: a breadth-first search from all of them at once. -1 where none is.
std::vector<int> nearestMarked(std::span<const std::uint8_t> marked, int columns, int rows);

}  // namespace facezip::raster
