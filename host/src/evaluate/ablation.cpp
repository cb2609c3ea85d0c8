#include "evaluate/ablation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "bands/covered_texels.hpp"
#include "bands/map_bands.hpp"
#include "evaluate/baseline_packages.hpp"
#include "evaluate/map_measurement.hpp"
#include "raster/texel_masks.hpp"

namespace facezip::evaluate {
namespace {
constexpr Method kMethods[] = {Method::kNoPermutation, Method::kPaper, Method::kClosedLoop, Method::kRefined};

/// RMSE of a package on every map, pooled over expressions.
std::vector<double> measurePackage(const Subject& subject, const Package& package, const std::string& label) {
  PackageDecoder decoder(package, subject.device);
  const std::vector<PackageDecoder*> decoders = {&decoder};
  const compress::MapSet maps = openMaps(subject);  // not longer than needed: it keeps every texture's file open
  std::vector<double> rmse;
  for (std::size_t m = 0; m < maps.maps.size(); ++m) {
    const compress::OpenMap& map = maps.maps[m];
    decoder.openMap(static_cast<int>(m));
    subject.progress.stage(fmt::format("{}: evaluating: {}", label, map.source->name),
                           static_cast<std::size_t>(map.samples->shape().height));
    MapMeasurement measurement(decoders, subject.expressions(), {});
    map.samples->forEachBand(bandRows(subject, map, decoders, 0), subject.progress, [&](const image::SampleBand& band) {
      const compress::BandShape shape = compress::bandShape(*map.samples, band.end - band.begin);
      const auto texels = compress::coveredTexels(shape, raster::coverageTiles(*map.raster, band.begin, band.end));
      measurement.addBand(band.begin, band.end, band.samples, shape, texels);
      subject.progress.advance(static_cast<std::size_t>(band.end));
    });
    rmse.push_back(measurement.errors().front().pooledTexels().rootMeanSquare());
  }
  return rmse;
}

void addMeasured(const std::string& method, int differences, Evaluation& evaluation) {
  for (Evaluation::Map& map : evaluation.maps) map.ablation[method][differences] = map.rmse.at(method).pooled;
  evaluation.ablation_bytes[method][differences] = evaluation.bytes.at(method);
}

void addPackage(const Subject& subject, Method method, int differences, Evaluation& evaluation) {
  const std::string key = nameOf(method);
  CompressOptions options = subject.recorded;
  options.method = method;
  options.differences = differences;
  const std::string label = fmt::format("{}, C = {}", key, differences);
  const TemporaryPackage temporary(subject.capture, options, label, subject.device, subject.progress);
  const std::vector<double> rmse = measurePackage(subject, temporary.package(), label);
  for (std::size_t m = 0; m < rmse.size(); ++m) evaluation.maps[m].ablation[key][differences] = rmse[m];
  evaluation.ablation_bytes[key][differences] = temporary.package().bytesInMemory();
}

}  // namespace

void addAblation(const Subject& subject, Evaluation& evaluation) {
  for (const Method method : kMethods) {
    const std::string key = nameOf(method);
    for (int differences = 1; differences <= kMostAblated; ++differences) {
      const bool measured = differences == evaluation.differences && evaluation.bytes.contains(key);
      if (measured) {
        addMeasured(key, differences, evaluation);
      } else {
        addPackage(subject, method, differences, evaluation);
      }
    }
  }
  evaluation.ablation_bytes["limit"] = evaluation.ablation_bytes.at(nameOf(Method::kPaper));
}

void addMaskSweep(const Subject& subject, const std::vector<int>& masks, Evaluation& evaluation) {
  std::vector<int> rising = masks;
  std::ranges::sort(rising);
  const auto [repeated, end] = std::ranges::unique(rising);
  rising.erase(repeated, end);
  for (const int count : rising) {
    MaskSweepPoint& point = evaluation.mask_sweep.emplace_back();
    point.masks = count;
    for (const Method method : {subject.recorded.method, Method::kPaper}) {
      const std::string key = nameOf(method);
      if (point.rmse.contains(key)) continue;
      CompressOptions options = subject.recorded;
      options.method = method;
      options.masks = count;
      const std::string label = fmt::format("{}, {} masks", key, count);
      const TemporaryPackage temporary(subject.capture, options, label, subject.device, subject.progress);
      point.rmse[key] = measurePackage(subject, temporary.package(), label);
    }
  }
}

}  // namespace facezip::evaluate
