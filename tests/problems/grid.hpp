// grid.hpp - a band of texels above a window of the weight grid: what the problems of the refinement's steps start
// from.
#pragma once

#include <Eigen/Dense>
#include <ostream>
#include <vector>

#include "problems/band.hpp"
#include "reference/weight_grid.hpp"
#include "refine/grid_band.hpp"
#include "refine/weight_window.hpp"

namespace facezip::test {

struct GridSizes {
  BandShape shape;
  int weight_scale = 8;  ///< texels to a cell
  int textures = 4;      ///< C
  int first_row = 0;     ///< of the band in its image
  int rows_below = 0;    ///< of the image behind the band
};

inline void PrintTo(const GridSizes& sizes, std::ostream* out) {
  *out << sizes.shape.width << "x" << sizes.shape.rows << "x" << sizes.shape.channels << " N" << sizes.shape.expressions
       << " s" << sizes.weight_scale << " C" << sizes.textures << " from row " << sizes.first_row;
}

/// A square map of three channels of 8 bits with every texel covered.
inline GridSizes squareSizes(int resolution, int expressions, int textures) {
  return {{resolution, resolution, 3, expressions, image::SampleType::kUint8}, 8, textures, 0, 0};
}

/// What is free in the window.
enum class Free { kAllRows, kAllButTheEnds };

/// Grid weights from a hash, the same for the references.
struct GridProblem : BandProblem {
  GridProblem(device::DeviceContext& device, const GridSizes& grid_sizes, TileMasks tile_masks, Free free)
      : BandProblem(device, grid_sizes.shape, std::move(tile_masks)),
        sizes(grid_sizes),
        space{
            raster::WeightGrid::over(shape.width, sizes.first_row + shape.rows + sizes.rows_below, sizes.weight_scale),
            sizes.textures, shape.expressions},
        window(device, space),
        tile_at(device.upload(tileLookup(masks, shape), "lookup of tiles")) {
    makeWeights(free);
  }

  compress::GridBand band() const { return {tiles, shape, differences.buffer(), sizes.first_row, sizes.weight_scale}; }

  /// Place of texel t of a tile in the image.
  int x(std::size_t tile, int t) const { return masks.tiles[tile].x * kTileSide + t % kTileSide; }
  int y(std::size_t tile, int t) const { return sizes.first_row + masks.tiles[tile].y * kTileSide + t / kTileSide; }
  double texelWeight(std::size_t tile, int t) const {
    return static_cast<double>(masks.texel_weights[Layout(tileCount(), kTileTexels)(tile, t)]);
  }
  bool wanted(std::size_t tile, int t) const {
    return masks.mask_weights[Layout(tileCount(), kTileTexels)(tile, t)] > 0.0f;
  }
  /// Delta of a texel, N x channels.
  Eigen::MatrixXd deltaOf(std::size_t tile, int t) const {
    Eigen::MatrixXd of_texel(shape.expressions, shape.channels);
    for (int n = 0; n < shape.expressions; ++n) {
      for (int c = 0; c < shape.channels; ++c) of_texel(n, c) = delta()[deltaLayout()(tile, n, c, t)];
    }
    return of_texel;
  }
  /// w_n at a texel, C x N.
  Eigen::MatrixXd weightsOf(std::size_t tile, int t) const { return weights.texel(x(tile, t), y(tile, t)); }

  /// [tile][texture * channels + channel][256]
  Layout<3> textureLayout() const { return Layout(tileCount(), planes(), kTileTexels); }
  int planes() const { return space.textures * shape.channels; }
  /// D of a texel in values of textureLayout(), C x channels.
  Eigen::MatrixXd textureOf(const std::vector<float>& textures, std::size_t tile, int t) const {
    Eigen::MatrixXd d(space.textures, shape.channels);
    for (int plane = 0; plane < planes(); ++plane) {
      d(plane / shape.channels, plane % shape.channels) =
          static_cast<double>(textures[textureLayout()(tile, plane, t)]);
    }
    return d;
  }

  /// [row of the window][column][C][lanes]
  Layout<4> weightLayout() const { return Layout(window.rows().count(), space.columns, space.textures, space.lanes()); }
  /// The window's weights in a copy of the whole grid.
  reference::GridWeights currentWeights() const {
    reference::GridWeights grid = weights;
    const std::vector<float> values = window.weights();
    for (int row = window.rows().begin; row < window.rows().end; ++row) {
      for (int column = 0; column < grid.columns; ++column) {
        for (int i = 0; i < grid.textures; ++i) {
          for (int n = 0; n < grid.expressions; ++n) {
            grid.at(row, column, i, n) =
                static_cast<double>(values[weightLayout()(row - window.rows().begin, column, i, n)]);
          }
        }
      }
    }
    return grid;
  }

  /// Cells that the texels of the band do not reach become NaN: no step may look at them.
  void spoilOtherCells() {
    const raster::CellRows reached =
        raster::cellRowsOf(sizes.first_row, sizes.first_row + shape.rows, sizes.weight_scale, space.rows);
    const compress::WindowRows rows = window.rows();
    std::vector<float> values = window.weights();
    for (int row = rows.begin; row < rows.end; ++row) {
      if (row >= reached.begin && row < reached.end) continue;
      std::fill_n(values.begin() + static_cast<std::ptrdiff_t>(weightLayout()(row - rows.begin, 0, 0, 0)),
                  space.rowFloats(), std::numeric_limits<float>::quiet_NaN());
    }
    window.set(rows, values, values);
  }

  // What steps must move.
  double cells() const { return static_cast<double>(space.cellCount()); }
  double pairs() const { return FACEZIP_PAIRS(space.textures); }
  double textureBytes() const { return static_cast<double>(textureLayout().size() * sizeof(float)); }
  double weightBytes() const { return cells() * static_cast<double>(space.cellFloats() * sizeof(float)); }
  double systemBytes() const { return cells() * static_cast<double>(space.systemEntries() * sizeof(float)); }

  GridSizes sizes;
  compress::WeightSpace space;
  compress::WeightWindow window;
  cl::Buffer tile_at;
  reference::GridWeights weights;  ///< of the whole grid; floats

 private:
  void makeWeights(Free free) {
    Hashed hashed(9);
    weights = {space.columns, space.rows, sizes.weight_scale, space.textures, space.expressions, {}};
    weights.values.resize(toSize(space.columns, space.rows, space.textures, space.expressions));
    for (double& value : weights.values) value = static_cast<double>(hashed.between(-0.5f, 1.5f));
    compress::WindowRows rows;
    rows.begin = std::max(0, sizes.first_row / sizes.weight_scale - 1);
    rows.end = std::min(space.rows, (sizes.first_row + shape.rows) / sizes.weight_scale + 2);
    const int fixed = free == Free::kAllRows ? 0 : 1;
    rows.free_begin = std::min(rows.begin + fixed, rows.end);
    rows.free_end = std::max(rows.end - fixed, rows.free_begin);
    const Layout places(rows.count(), space.columns, space.textures, space.lanes());
    std::vector<float> values(places.size(), 0.0f);
    for (int row = rows.begin; row < rows.end; ++row) {
      for (int column = 0; column < space.columns; ++column) {
        for (int i = 0; i < space.textures; ++i) {
          for (int n = 0; n < space.expressions; ++n) {
            values[places(row - rows.begin, column, i, n)] = static_cast<float>(weights.at(row, column, i, n));
          }
        }
      }
    }
    window.set(rows, values, values);
  }
};

}  // namespace facezip::test
