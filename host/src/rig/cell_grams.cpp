#include "rig/cell_grams.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>

#include "bands/covered_texels.hpp"
#include "bands/map_bands.hpp"
#include "raster/uv_raster.hpp"

namespace facezip::rig {
namespace {

/// Rows of cells that a band of the textures has: whole cells, about 64 rows of texels.
constexpr int kBandRows = 64;

/// Differences of the covered texels of one cell: N by texels x channels.
Eigen::MatrixXf differencesOf(const std::vector<float>& values, const std::vector<raster::TexelSample>& raster,
                              const compress::BandShape& shape, int x_begin, int x_end, int y_begin, int y_end) {
  std::vector<std::size_t> texels;
  for (int y = y_begin; y < y_end; ++y) {
    for (int x = x_begin; x < x_end; ++x) {
      const auto texel =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(shape.width) + static_cast<std::size_t>(x);
      if (raster[texel].kind == raster::TexelSample::Kind::kCovered) texels.push_back(texel);
    }
  }
  const auto channels = static_cast<std::size_t>(shape.channels);
  const std::size_t image = values.size() / static_cast<std::size_t>(shape.expressions + 1);
  Eigen::MatrixXf differences(shape.expressions, static_cast<Eigen::Index>(texels.size() * channels));
  for (int n = 0; n < shape.expressions; ++n) {
    Eigen::Index column = 0;
    for (const std::size_t texel : texels) {
      for (std::size_t c = 0; c < channels; ++c) {
        const std::size_t at = texel * channels + c;
        differences(n, column++) = values[static_cast<std::size_t>(n + 1) * image + at] - values[at];
      }
    }
  }
  return differences;
}

}  // namespace

std::vector<SolvedCell> gatherCells(std::span<const compress::GridMap> maps, const SkinFeatures& features,
                                    const std::vector<raster::TexelSample>& samples, int columns, std::size_t most,
                                    double& covered_samples, Progress& progress) {
  std::vector<int> sampled;
  for (std::size_t c = 0; c < samples.size(); ++c) {
    if (samples[c].triangle >= 0) sampled.push_back(static_cast<int>(c));
  }
  // A stride that is no divisor of a row spreads over columns too.
  const std::size_t stride = std::max<std::size_t>(1, sampled.size() / std::max<std::size_t>(most, 1));
  std::vector<int> chosen;
  for (std::size_t i = 0; i < sampled.size(); i += stride) chosen.push_back(sampled[i]);
  std::vector<SolvedCell> cells(chosen.size());
  std::vector<double> counts(chosen.size(), 0.0);
  const auto expressions = static_cast<Eigen::Index>(maps.front().map->samples->expressions());
  tbb::parallel_for(std::size_t{0}, chosen.size(), [&](std::size_t i) {
    cells[i] = {features.at(samples[static_cast<std::size_t>(chosen[i])]),
                Eigen::MatrixXd::Zero(expressions, expressions)};
  });
  for (const compress::GridMap& map : maps) {
    const int scale = map.weight_scale;
    const int band_rows = std::max(1, kBandRows / scale) * scale;
    std::vector<float> values;
    progress.stage(fmt::format("inner products: {}", map.map->source->name),
                   static_cast<std::size_t>(map.map->samples->shape().height));
    map.map->samples->forEachBand(band_rows, progress, [&](const image::SampleBand& band) {
      const compress::BandShape shape = compress::bandShape(*map.map->samples, band.end - band.begin);
      values.resize(band.samples.size() / image::sampleBytes(shape.sample_type));
      compress::toValues(band.samples, shape.sample_type, values);
      const std::vector<raster::TexelSample> raster = map.map->raster->coveredRows(band.begin, band.end);
      const auto first = std::lower_bound(chosen.begin(), chosen.end(), band.begin / scale * columns);
      const auto last = std::lower_bound(first, chosen.end(), (band.end + scale - 1) / scale * columns);
      tbb::parallel_for(first - chosen.begin(), last - chosen.begin(), [&](std::ptrdiff_t i) {
        const int cell = chosen[static_cast<std::size_t>(i)], x = cell % columns * scale,
                  y = cell / columns * scale - band.begin;
        const Eigen::MatrixXf differences = differencesOf(values, raster, shape, x, std::min(x + scale, shape.width), y,
                                                          std::min(y + scale, band.end - band.begin));
        cells[static_cast<std::size_t>(i)].gram +=
            map.fit_weight * (differences * differences.transpose()).cast<double>();
        counts[static_cast<std::size_t>(i)] += map.fit_weight * static_cast<double>(differences.cols());
      });
      progress.advance(static_cast<std::size_t>(band.end));
    });
  }
  covered_samples = 0.0;
  for (const double count : counts) covered_samples += count;
  return cells;
}

}  // namespace facezip::rig
