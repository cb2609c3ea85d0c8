#include "raster/nearest_marked.hpp"

#include <cstddef>
#include <queue>
#include <utility>

#include "io/counts.hpp"

namespace facezip::raster {

std::vector<int> nearestMarked(std::span<const std::uint8_t> marked, int columns, int rows) {
  std::vector<int> source(marked.size(), -1);
  std::queue<int> front;
  for (std::size_t c = 0; c < marked.size(); ++c) {
    if (marked[c] == 0) continue;
    source[c] = static_cast<int>(c);
    front.push(static_cast<int>(c));
  }
  for (; !front.empty(); front.pop()) {
    const int cell = front.front();
    const int x = cell % columns;
    const int y = cell / columns;
    for (const auto& [nx, ny] : {std::pair{x - 1, y}, std::pair{x + 1, y}, std::pair{x, y - 1}, std::pair{x, y + 1}}) {
      if (nx < 0 || ny < 0 || nx >= columns || ny >= rows) continue;
      int& next = source[toSize(ny * columns + nx)];
      if (next >= 0) continue;
      next = source[toSize(cell)];
      front.push(ny * columns + nx);
    }
  }
  return source;
}

}  // namespace facezip::raster
