#include "compress/compress_stretch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "bands/difference.hpp"
#include "facezip/geometry/skin_strain.hpp"
#include "io/counts.hpp"
#include "raster/cell_samples.hpp"
#include "refine/difference_fit.hpp"
#include "refine/refinement.hpp"

namespace facezip::compress {
namespace {

/// Where the running sum of a cell's shares is rounded, 0 to 1. The R2 sequence (Roberts 2018) spreads it evenly over
/// any few neighbouring cells, which bilinear interpolation then averages. Clear of 0 and 1, so that shares that are
/// whole codes already keep them.
double roundingPhase(std::size_t column, std::size_t row) {
  const double phase = 0.7548776662466927 * static_cast<double>(column) + 0.5698402909980532 * static_cast<double>(row);
  return 0.01 + 0.98 * (phase - std::floor(phase));
}

}  // namespace

Eigen::MatrixXd vertexInfluences(const geometry::TriangleMesh& neutral,
                                 const std::vector<Eigen::MatrixX3d>& expressions) {
  const geometry::SkinStrain skin(neutral.positions, neutral.triangles);
  const Eigen::ArrayXd before = skin.ringLengths(neutral.positions).array();
  const Eigen::ArrayXd unit = (before > 0.0).select(kInfluenceUnit * before, std::numeric_limits<double>::infinity());
  Eigen::MatrixXd influences(neutral.positions.rows(), 2 * static_cast<Eigen::Index>(expressions.size()));
  for (std::size_t n = 0; n < expressions.size(); ++n) {
    const Eigen::ArrayXd change = (skin.ringLengths(expressions[n]).array() - before) / unit;
    const auto column = 2 * static_cast<Eigen::Index>(n);
    influences.col(column) = (-change).max(0.0);
    influences.col(column + 1) = change.max(0.0);
  }
  return influences;
}

int InfluenceShares::steps(int map) const {
  float most = 0.0f;
  for (std::size_t cell = 0; cell < cells(); ++cell) {
    const float* of_map = shares.data() + (cell * kCompressStretchMaps + toSize(map)) * toSize(members);
    most = std::max(most, *std::max_element(of_map, of_map + members));
  }
  // A whole number, so that sums of codes are whole too; one less than the quotient, which was rounded.
  return most > 0.0f ? std::max(255, static_cast<int>(std::min(255.0 / static_cast<double>(most), 1e6)) - 1) : 255;
}

InfluenceShares normalisedInfluences(const geometry::TriangleMesh& neutral, const Eigen::MatrixXd& influences,
                                     const raster::UvRaster& raster, int scale) {
  const Eigen::Index members = influences.cols() / 2;
  const int columns = (raster.width() + scale - 1) / scale;
  const int rows = (raster.height() + scale - 1) / scale;
  const std::vector<raster::TexelSample> samples = raster::cellSamples(raster, scale);
  const std::vector<int> source = raster::nearestSampled(samples, columns, rows);
  InfluenceShares found{static_cast<int>(members), columns, {}};
  found.shares.assign(samples.size() * toSize(kCompressStretchMaps * members), 0.0f);
  for (std::size_t cell = 0; cell < samples.size(); ++cell) {
    if (source[cell] < 0) continue;
    const raster::TexelSample& at = samples[toSize(source[cell])];
    const auto corner = [&](int c) { return influences.row(neutral.triangles(at.triangle, c)).array(); };
    const Eigen::ArrayXd here = static_cast<double>(at.b0) * corner(0) + static_cast<double>(at.b1) * corner(1) +
                                (1.0 - static_cast<double>(at.b0) - static_cast<double>(at.b1)) * corner(2);
    for (int i = 0; i < kCompressStretchMaps; ++i) {
      const Eigen::ArrayXd of_map = here.reshaped(2, members).row(i);
      const Eigen::ArrayXd shares = (of_map - of_map.maxCoeff()).exp();  // Eq. 12, without overflow
      float* to = found.shares.data() + (cell * kCompressStretchMaps + toSize(i)) * toSize(members);
      Eigen::Map<Eigen::ArrayXf>(to, members) = (shares / shares.sum()).cast<float>();
    }
  }
  return found;
}

std::vector<std::uint8_t> shareCodes(const InfluenceShares& shares,
                                     const std::array<int, kCompressStretchMaps>& steps) {
  const std::size_t cells = shares.cells(), members = toSize(shares.members);
  std::vector<std::uint8_t> codes(members * cells * kCompressStretchMaps, 0);
  for (std::size_t cell = 0; cell < cells; ++cell) {
    const double phase = roundingPhase(cell % toSize(shares.columns), cell / toSize(shares.columns));
    for (std::size_t i = 0; i < kCompressStretchMaps; ++i) {
      const float* of_map = shares.shares.data() + (cell * kCompressStretchMaps + i) * members;
      const double sum = std::accumulate(of_map, of_map + members, 0.0);
      if (!(sum > 0.0)) continue;
      // The running sum is rounded, and each share gets what it adds to that: the last one ends at `steps`.
      double running = 0.0;
      int given = 0;
      for (std::size_t n = 0; n < members; ++n) {
        running += static_cast<double>(of_map[n]) / sum;
        const bool last = n + 1 == members;
        const int reached = last ? steps[i] : std::min(static_cast<int>(steps[i] * running + phase), steps[i]);
        codes[(n * cells + cell) * kCompressStretchMaps + i] =
            static_cast<std::uint8_t>(std::clamp(reached - given, 0, 255));
        given = reached;
      }
    }
  }
  return codes;
}

EncodedWeights encodeShares(const InfluenceShares& shares) {
  const std::array<int, kCompressStretchMaps> steps = {shares.steps(0), shares.steps(1)};
  return {{1.0 / steps[0], 1.0 / steps[1]}, {0.0, 0.0}, shareCodes(shares, steps)};
}

CompressStretchTextures::CompressStretchTextures(device::DeviceContext& context, const WeightSpace& space,
                                                 const EncodedWeights& influences, device::KernelVariant variant)
    : influences_(influences),
      context_(context),
      gpu_(context.resolve(variant) == device::KernelVariant::kGpu),
      window_(context, space),
      textures_(context, "compress and stretch maps") {}

TileMasks CompressStretchTextures::tiles(const OpenMap& map, int begin, int end) const {
  return raster::activeTiles(*map.classes, begin, end);
}

const cl::Buffer& CompressStretchTextures::compute(const GridMap& map, const MapBand& band) {
  const WeightSpace& space = window_.space();
  const WindowRows rows = cellRowsOf(band.begin, band.end, map.weight_scale, space.rows);
  std::vector<float> weights(toSize(rows.count()) * space.rowFloats());
  decodeRows(influences_, space, rows.begin, rows.end, weights);
  window_.set(rows, weights, weights);
  textures_.reserve(std::max<std::size_t>(
      1, band.tiles.tileCount() * toSize(kCompressStretchMaps * band.shape.channels) * kTileTexels * sizeof(float)));
  launchCompressStretch(context_, {band.tiles, band.shape, band.differences, band.begin, map.weight_scale}, window_,
                        gpu_, textures_.buffer());
  return textures_.buffer();
}

void launchCompressStretch(device::DeviceContext& context, const GridBand& band, const WeightWindow& window, bool gpu,
                           const cl::Buffer& textures) {
  const std::size_t tiles = band.tiles.tileCount();
  if (tiles == 0) return;
  device::requireBytes(context, band.differences, differenceBufferBytes(band.shape, tiles), "differences of a band");
  device::requireBytes(context, textures,
                       tiles * toSize(window.space().textures * band.shape.channels) * kTileTexels * sizeof(float),
                       "compress and stretch maps");
  const std::size_t rows = gpu ? 1 : kTileSide;
  const cl::Kernel kernel =
      context.kernel("compress_stretch.cl", "compress_stretch",
                     fmt::format("{} -D ROWS={}", gridDefines(band.shape, window.space(), band.weight_scale), rows));
  const std::size_t items = kTileTexels / rows;
  context.launch(kernel, device::WorkItems(items, tiles).inGroupsOf(context.workGroupSize(kernel, items), 1),
                 band.tiles.positions(), band.tiles.maskWeights(), band.differences, window.weightsBuffer(), textures,
                 band.first_row, window.rows().begin, window.space().columns, window.space().rows);
}

}  // namespace facezip::compress
