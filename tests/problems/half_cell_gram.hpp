// half_cell_gram.hpp - problem of the step `half_cell_gram`.
#pragma once

#include "problems/grid.hpp"
#include "reference/half_cell_gram.hpp"
#include "refine/half_cells.hpp"

namespace facezip::test {

/// Must move: differences and texel weights in, Gram matrices out. Operations: the root of the weight once, then a
/// product for each pair of expressions and channel.
struct HalfCellGramProblem : GridProblem {
  HalfCellGramProblem(device::DeviceContext& device, const GridSizes& grid_sizes, TileMasks tile_masks, Free free)
      : GridProblem(device, grid_sizes, std::move(tile_masks), free), halves(device, space) {}

  void run() {
    halves.moveTo(window.rows());
    halves.add(band(), tile_at, 1.0);
    context.finish();
  }
  /// Adds the band again, as a second map of this weight.
  void addAgain(double metric_weight) {
    halves.add(band(), tile_at, metric_weight);
    context.finish();
    added_ += metric_weight;
  }

  /// [half row][group][m (m + 1) / 2 + n][16], half rows from halves.rows().first on
  Layout<4> gramLayout() const {
    return Layout(halves.rows().count, halves.rows().groups, FACEZIP_PAIRS(space.expressions), FACEZIP_VECTOR);
  }
  std::vector<float> result() const {
    return context.download<float>(halves.grams(), gramLayout().size(), "Gram matrices of the half cells");
  }
  Eigen::MatrixXd expectedGram(int half_row, int half_column) const {
    return reference::halfCellGram(deltas(half_row, half_column));
  }

  /// Delta of the texels of a half cell times the roots of their weights, N x (texels * channels).
  Eigen::MatrixXd deltas(int half_row, int half_column) const {
    const int side = sizes.weight_scale / 2;
    Eigen::MatrixXd columns(shape.expressions, 0);
    for (std::size_t tile = 0; tile < tileCount(); ++tile) {
      for (int t = 0; t < kTileTexels; ++t) {
        if (y(tile, t) / side != half_row || x(tile, t) / side != half_column) continue;
        const Eigen::Index at = columns.cols();
        columns.conservativeResize(Eigen::NoChange, at + shape.channels);
        columns.rightCols(shape.channels) = std::sqrt(added_ * texelWeight(tile, t)) * deltaOf(tile, t);
      }
    }
    return columns;
  }

  double halfCells() const { return 4.0 * cells(); }
  double gramNumbers() const { return FACEZIP_PAIRS(space.expressions); }
  double gramBytes() const { return halfCells() * gramNumbers() * sizeof(float); }
  double bytes() const { return differenceBytes() + texelWeightBytes() + gramBytes(); }
  double flops() const { return texels() * shape.channels * (space.expressions + 2.0 * gramNumbers()); }

  compress::HalfCells halves;

 private:
  double added_ = 1.0;  ///< sum of the metric weights
};

}  // namespace facezip::test
