#include "register/colour_drift.hpp"

#include <algorithm>
#include <cmath>

#include "io/counts.hpp"

namespace facezip::registration {
namespace {

constexpr int kCell = 8;                         // texels: noise averages out, pores stay together
constexpr std::uint8_t kSure = 128;              // confidence
constexpr int kLeastTexels = kCell * kCell / 2;  // of a cell
constexpr double kDark = 0.02;                   // of full scale: ratios of dark cells are noise
constexpr std::size_t kLeastCells = 20;

/// Sums over the texels of a cell that both textures show.
struct Cell {
  int texels = 0;
  double movement = 0.0;
  double neutral[3] = {}, expression[3] = {};
};

double medianOf(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

std::vector<Cell> cellsOf(const raster::UvRaster& raster, const geometry::TriangleMesh& mesh,
                          const Eigen::VectorXd& movement, const BakedTexture& neutral, const BakedTexture& texture) {
  const int columns = divideUp(raster.width(), kCell);
  const auto channels = toSize(texture.channels);
  std::vector<Cell> cells;
  for (int begin = 0; begin < raster.height(); begin += kCell) {
    const int end = std::min(begin + kCell, raster.height());
    const std::vector<raster::TexelSample> samples = raster.rows(begin, end);
    std::vector<Cell> row(toSize(columns));
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const std::size_t at = toSize(begin) * toSize(raster.width()) + i;
      if (samples[i].triangle < 0 || neutral.confidence[at] < kSure || texture.confidence[at] < kSure) continue;
      Cell& cell = row[i % toSize(raster.width()) / kCell];
      ++cell.texels;
      for (int k = 0; k < 3; ++k) cell.movement += movement[mesh.triangles(samples[i].triangle, k)] / 3.0;
      for (std::size_t c = 0; c < channels; ++c) {
        cell.neutral[c] += double{neutral.samples[at * channels + c]};
        cell.expression[c] += double{texture.samples[at * channels + c]};
      }
    }
    std::copy_if(row.begin(), row.end(), std::back_inserter(cells),
                 [](const Cell& cell) { return cell.texels >= kLeastTexels; });
  }
  return cells;
}

}  // namespace

std::vector<double> colourGains(const raster::UvRaster& raster, const geometry::TriangleMesh& mesh,
                                const Eigen::MatrixX3d& neutral, const Eigen::MatrixX3d& moved,
                                const BakedTexture& neutral_texture, const BakedTexture& texture) {
  std::vector<double> gains(toSize(texture.channels), 1.0);
  std::vector<Cell> cells = cellsOf(raster, mesh, (moved - neutral).rowwise().norm(), neutral_texture, texture);
  std::sort(cells.begin(), cells.end(),
            [](const Cell& a, const Cell& b) { return a.movement * b.texels < b.movement * a.texels; });
  cells.resize(cells.size() / 2);
  for (std::size_t c = 0; c < gains.size(); ++c) {
    std::vector<double> ratios;
    for (const Cell& cell : cells) {
      if (cell.neutral[c] < kDark * cell.texels || cell.expression[c] < kDark * cell.texels) continue;
      ratios.push_back(cell.expression[c] / cell.neutral[c]);
    }
    if (ratios.size() >= kLeastCells) gains[c] = medianOf(ratios);
  }
  return gains;
}

void takeOut(const std::vector<double>& gains, BakedTexture& texture) {
  const auto channels = toSize(texture.channels);
  for (std::size_t i = 0; i < texture.samples.size(); ++i) {
    texture.samples[i] = static_cast<float>(double{texture.samples[i]} / gains[i % channels]);
  }
}

}  // namespace facezip::registration
