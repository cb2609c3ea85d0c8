// weight_system.hpp - problem of the step `weight_system`: the sums of every tile.
#pragma once

#include "problems/difference_fit.hpp"
#include "refine/weight_system.hpp"

namespace facezip::test {

/// Numbers of a cell's equations, as both the device and the reference have them.
struct CellEntries {
  const compress::WeightSpace& space;

  int count() const { return static_cast<int>(space.systemEntries()); }
  /// Block 0: to itself; 1: to the cell on the right; 2: below; 3: below on the right. j <= i.
  int block(int which, int i, int j) const { return which * FACEZIP_PAIRS(space.textures) + i * (i + 1) / 2 + j; }
  int side(int i, int n) const {
    return FACEZIP_CELL_MATRICES(space.textures) + i * static_cast<int>(space.lanes()) + n;
  }
};

/// Must move: differences, texel weights and textures in, the sums of the tiles out. Operations: for each pair of
/// textures a product over channels and its share in three pairs of rows; for each expression the weighted difference,
/// a product with each texture and its share in two rows.
struct WeightSystemProblem : DifferenceFitProblem {
  WeightSystemProblem(device::DeviceContext& device, const GridSizes& grid_sizes, TileMasks tile_masks, Free free,
                      device::KernelVariant variant = device::KernelVariant::kAuto)
      : DifferenceFitProblem(device, grid_sizes, std::move(tile_masks), free, variant), system(device, space, variant) {
    DifferenceFitProblem::run();
  }

  void run() {
    system.sumTiles(band(), fit.textures());
    context.finish();
  }

  /// Cells along either axis of what a tile sums.
  int patchSide() const { return FACEZIP_CELLS_OF_16(sizes.weight_scale); }
  /// [tile][row of the patch][column of the patch][entry]
  Layout<4> sumLayout() const { return Layout(tileCount(), patchSide(), patchSide(), space.systemEntries()); }
  std::vector<float> result() const {
    return context.download<float>(system.tileSums(), sumLayout().size(), "sums of the tiles");
  }
  /// First cell of a tile's patch.
  int patchRow(std::size_t tile) const { return firstCell(y(tile, 0), space.rows); }
  int patchColumn(std::size_t tile) const { return firstCell(x(tile, 0), space.columns); }

  /// All entries of cell (row, column), summed over the given texels.
  std::vector<double> cellEntries(const std::vector<reference::FitTexel>& texels, int row, int column) const {
    const CellEntries entries{space};
    std::vector<double> cell(toSize(entries.count()), 0.0);
    for (int block = 0; block < 4; ++block) {
      const Eigen::MatrixXd expected =
          reference::systemBlock(weights, texels, row, column, row + block / 2, column + block % 2);
      for (int i = 0; i < space.textures; ++i) {
        for (int j = 0; j <= i; ++j) cell[toSize(entries.block(block, i, j))] = expected(i, j);
      }
    }
    const Eigen::MatrixXd sides = reference::systemSides(weights, texels, row, column);
    for (int i = 0; i < space.textures; ++i) {
      for (int n = 0; n < space.expressions; ++n) cell[toSize(entries.side(i, n))] = sides(i, n);
    }
    return cell;
  }

  double sumBytes() const { return static_cast<double>(sumLayout().size() * sizeof(float)); }
  double bytes() const { return differenceBytes() + texelWeightBytes() + textureBytes() + sumBytes(); }
  double flops() const {
    const double channels = shape.channels;
    const double blocks = pairs() * (2.0 * channels + 6.0);
    const double sides = space.expressions * (channels + space.textures * (2.0 * channels + 4.0));
    return texels() * (blocks + sides);
  }

  compress::WeightSystem system;

 private:
  int firstCell(int texel, int cells) const {
    return raster::cellRowsOf(texel, texel + 1, sizes.weight_scale, cells).begin;
  }
};

}  // namespace facezip::test
