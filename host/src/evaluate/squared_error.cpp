#include "evaluate/squared_error.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cassert>
#include <cstdint>
#include <numeric>
#include <vector>

namespace facezip::evaluate {
namespace {

using compress::BandShape;
using compress::kTileSide;
using compress::kTileTexels;
using compress::TileMasks;

template <typename Sample>
double tileError(const Sample* a, const Sample* b, const BandShape& shape, compress::TilePosition tile,
                 const float* weights) {
  const int x_begin = tile.x * kTileSide;
  const int y_begin = tile.y * kTileSide;
  const int columns = std::min(kTileSide, shape.width - x_begin);
  const int rows = std::min(kTileSide, shape.rows - y_begin);
  double sum = 0.0;
  for (int y = 0; y < rows; ++y) {
    const std::size_t first = (static_cast<std::size_t>(y_begin + y) * static_cast<std::size_t>(shape.width) +
                               static_cast<std::size_t>(x_begin)) *
                              static_cast<std::size_t>(shape.channels);
    for (int x = 0; x < columns; ++x) {
      if (weights[y * kTileSide + x] <= 0.0f) continue;
      for (int c = 0; c < shape.channels; ++c) {
        const std::size_t at = first + static_cast<std::size_t>(x * shape.channels + c);
        const double difference = static_cast<double>(a[at]) - static_cast<double>(b[at]);
        sum += difference * difference;
      }
    }
  }
  return sum;
}

template <typename Sample>
double bandError(std::span<const std::byte> a, std::span<const std::byte> b, const BandShape& shape,
                 const TileMasks& covered) {
  std::vector<double> sums(covered.tiles.size());
  tbb::parallel_for(std::size_t{0}, sums.size(), [&](std::size_t t) {
    sums[t] = tileError(reinterpret_cast<const Sample*>(a.data()), reinterpret_cast<const Sample*>(b.data()), shape,
                        covered.tiles[t], covered.texel_weights.data() + t * kTileTexels);
  });
  return std::accumulate(sums.begin(), sums.end(), 0.0);
}

}  // namespace

double squaredError(std::span<const std::byte> a, std::span<const std::byte> b, const BandShape& shape,
                    const TileMasks& covered) {
  assert(a.size() == b.size());
  const double unit = image::unit255(shape.sample_type);
  switch (shape.sample_type) {
    case image::SampleType::kUint8:
      return unit * unit * bandError<std::uint8_t>(a, b, shape, covered);
    case image::SampleType::kUint16:
      return unit * unit * bandError<std::uint16_t>(a, b, shape, covered);
    case image::SampleType::kFloat32:
      break;
  }
  return unit * unit * bandError<float>(a, b, shape, covered);
}

}  // namespace facezip::evaluate
