#include "evaluate/map_evaluation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "bands/covered_texels.hpp"
#include "evaluate/ablation.hpp"
#include "evaluate/blend_error.hpp"
#include "evaluate/error_pictures.hpp"
#include "evaluate/map_measurement.hpp"
#include "evaluate/normal_angle.hpp"
#include "evaluate/pca.hpp"
#include "evaluate/texel_errors.hpp"
#include "raster/texel_masks.hpp"
#include "rate/block_rank_energy.hpp"
#include "search/gram.hpp"

namespace facezip::evaluate {
namespace {
using namespace compress;

/// What one pass over a map's textures finds.
struct MapPass {
  Eigen::MatrixXd gram;               ///< of the differences over all covered texels, N x N
  RankEnergy limit;                   ///< of blocks of a weight cell
  std::vector<PackageErrors> errors;  ///< of each candidate
  std::uint64_t covered_texels = 0;
  double samples = 0.0;  ///< covered texels x channels
};

template <typename Summary>
auto pooledAndEach(const ErrorDistribution& pooled, const std::vector<ErrorDistribution>& each,
                   const Summary& summarize) {
  PooledAndEach<decltype(summarize(pooled))> result{summarize(pooled), {}};
  for (const ErrorDistribution& distribution : each) result.per_expression.push_back(summarize(distribution));
  return result;
}

MapErrors pcaErrors(const Eigen::MatrixXd& gram, int components, double samples) {
  MapErrors errors;
  double sum = 0.0;
  for (const double squared : pcaSquaredErrors(gram, components)) {
    sum += squared;
    errors.per_expression.push_back(std::sqrt(squared / samples));
  }
  errors.pooled = std::sqrt(sum / (samples * static_cast<double>(gram.rows())));
  return errors;
}

double limitError(const MapPass& pass, int components) {
  const double residual = pass.limit.residual[static_cast<std::size_t>(components)];
  return std::sqrt(residual / (pass.samples * static_cast<double>(pass.gram.rows())));
}

std::vector<PackageDecoder*> openDecoders(const OpenMap& map, int index, const Candidates& candidates) {
  std::vector<PackageDecoder*> decoders;
  for (const Candidate& candidate : candidates.all) {
    const Package& package = candidate.decoder->package();
    requireSameShape(map, package.maps()[static_cast<std::size_t>(index)], package);
    candidate.decoder->openMap(index);
    decoders.push_back(candidate.decoder.get());
  }
  return decoders;
}

/// Gram matrices of the map's differences and of its blocks', and every package decoded beside it.
MapPass measureMap(const OpenMap& map, int side, const std::vector<PackageDecoder*>& decoders, const Subject& subject,
                   bool blocks_wanted, const MapMeasurement::Wanted& wanted, BandBuffers& buffers) {
  const image::ImageShape& shape = map.samples->shape();
  const int expressions = subject.expressions();
  MapMeasurement measurement(decoders, expressions, wanted);
  GramAccumulator accumulator(subject.device.context(), GramSlots{}, expressions);
  BlockRankEnergy blocks({side}, shape.width, shape.height, shape.channels, expressions);
  const auto block_row = static_cast<std::uint64_t>(shape.width / side + 1) * static_cast<std::uint64_t>(expressions) *
                         static_cast<std::uint64_t>(expressions) * sizeof(double);
  const int rows =
      bandRows(subject, map, decoders, block_row + (wanted.pictures != nullptr ? wanted.pictures->bytes() : 0));
  MapPass pass;
  const auto make_tiles = [&](int begin, int end) { return raster::coverageTiles(*map.raster, begin, end); };
  forEachMapBand(*map.samples, rows, buffers, make_tiles, fmt::format("evaluating: {}", map.source->name),
                 subject.progress, [&](const MapBand& band) {
                   const auto texels = coveredTexels(band.shape, band.masks);
                   pass.covered_texels += texels.size();
                   accumulator.add(band.tiles, band.differences, band.shape, 1.0);
                   if (blocks_wanted) blocks.addBand(band.begin, band.samples, band.shape, texels);
                   measurement.addBand(band.begin, band.end, band.samples, band.shape, texels);
                 });
  const GramMatrices grams = accumulator.finish();
  pass.gram = grams.slot(grams.slots.whole());
  pass.limit = blocks.energies().front();
  pass.errors = measurement.errors();
  pass.samples = static_cast<double>(pass.covered_texels) * shape.channels;
  return pass;
}

void addDecoded(const std::string& key, const PackageErrors& errors,
                const std::vector<std::vector<float>>& blend_weights, Evaluation::Map& result) {
  const auto detail = pooledAndEach(errors.pooledTexels(), errors.texels, summarizeTexelErrors);
  MapErrors& rmse = result.rmse[key];
  rmse.pooled = detail.pooled.rmse;
  for (const TexelErrors& each : detail.per_expression) rmse.per_expression.push_back(each.rmse);
  result.detail[key] = detail;
  if (!errors.angles.empty()) {
    result.angles[key] = pooledAndEach(errors.pooledAngles(), errors.angles, summarizeNormalAngles);
  }
  if (!errors.blends.empty()) result.blends[key] = summarizeBlendErrors(errors.blends, blend_weights, errors.texels);
}

void addUndecodedAblation(const MapPass& pass, Evaluation::Map& result) {
  for (int components = 1; components <= kMostAblated; ++components) {
    result.ablation["limit"][components] = limitError(pass, components);
    result.ablation["pca"][components] = pcaErrors(pass.gram, components, pass.samples).pooled;
  }
  result.ablation["pca"][8] = pcaErrors(pass.gram, 8, pass.samples).pooled;
}

Evaluation::Map summarize(const OpenMap& map, const MapPass& pass, const Candidates& candidates, int differences,
                          const EvaluateOptions& options, const std::vector<std::vector<float>>& blend_weights) {
  Evaluation::Map result;
  result.name = map.source->name;
  result.rms_difference = std::sqrt(pass.gram.trace() / (pass.samples * static_cast<double>(pass.gram.rows())));
  const auto& wanted = options.baselines;
  if (wanted.contains(Baseline::kPca4)) result.rmse[nameOf(Baseline::kPca4)] = pcaErrors(pass.gram, 4, pass.samples);
  if (wanted.contains(Baseline::kPca8)) result.rmse[nameOf(Baseline::kPca8)] = pcaErrors(pass.gram, 8, pass.samples);
  if (wanted.contains(Baseline::kLimit)) result.rmse[nameOf(Baseline::kLimit)] = {limitError(pass, differences), {}};
  for (std::size_t c = 0; c < candidates.all.size(); ++c) {
    addDecoded(candidates.all[c].key, pass.errors[c], blend_weights, result);
  }
  for (const std::string& key : candidates.own_keys) addDecoded(key, pass.errors.front(), blend_weights, result);
  if (options.ablation) addUndecodedAblation(pass, result);
  return result;
}

/// Methods whose images a picture may show; PCA(4) beside them.
bool isShown(const std::string& key, const PictureOptions& options) {
  return key == "package" || (options.paper_and_pca && key == nameOf(Method::kPaper));
}

PictureCollector collectorOf(const OpenMap& map, const Candidates& candidates, const Subject& subject,
                             const EvaluateOptions& options) {
  std::vector<int> columns;
  std::vector<std::string> methods;
  for (const Candidate& candidate : candidates.all) {
    const bool shown = isShown(candidate.key, *options.pictures);
    columns.push_back(shown ? static_cast<int>(methods.size()) : -1);
    if (shown) methods.push_back(candidate.key);
  }
  if (options.pictures->paper_and_pca && options.baselines.contains(Baseline::kPca4)) {
    methods.push_back(nameOf(Baseline::kPca4));
  }
  return {map.source->name, map.samples->shape(), subject.expressions(), columns, methods, options.pictures->side};
}

/// PCA's components are known only after the pass: its errors take another.
void addPcaPictures(const OpenMap& map, const Subject& subject, const Eigen::MatrixXd& projector,
                    PictureCollector& pictures) {
  subject.progress.stage(fmt::format("picture: {}", map.source->name),
                         static_cast<std::size_t>(map.samples->shape().height));
  const int rows = bandRows(subject, map, {}, pictures.bytes());
  map.samples->forEachBand(rows, subject.progress, [&](const image::SampleBand& band) {
    const BandShape shape = bandShape(*map.samples, band.end - band.begin);
    const auto texels = coveredTexels(shape, raster::coverageTiles(*map.raster, band.begin, band.end));
    pictures.addPca(band.begin, band.samples, shape, texels, projector);
    subject.progress.advance(static_cast<std::size_t>(band.end));
  });
}

ErrorPictures finishPictures(const OpenMap& map, const MapPass& pass, const Evaluation::Map& result,
                             const PictureOptions& options, const Subject& subject, PictureCollector& pictures) {
  double largest_p99 = 0.0;
  for (const auto& [key, detail] : result.detail) {
    if (isShown(key, options)) largest_p99 = std::max(largest_p99, detail.pooled.p99);
  }
  const Eigen::MatrixXd projector = pcaProjector(pass.gram, 4);
  if (pictures.wantsPca()) addPcaPictures(map, subject, projector, pictures);
  return pictures.finish(largest_p99, projector);
}

bool wantsPictures(const EvaluateOptions& options, const Package& package, int index) {
  if (!options.pictures) return false;
  const std::string& map = options.pictures->map;
  if (map.empty()) return options.pictures->all_maps || index == 0;
  return package.mapIndex(map) == index;
}

}  // namespace

MapEvaluation evaluateMap(const OpenMap& map, int index, const Candidates& candidates, const Subject& subject,
                          const EvaluateOptions& options, const std::vector<std::vector<float>>& blend_weights,
                          BandBuffers& buffers) {
  const Package& package = candidates.all.front().decoder->package();
  std::optional<PictureCollector> pictures;
  if (wantsPictures(options, package, index)) pictures.emplace(collectorOf(map, candidates, subject, options));
  const int side = package.maps()[static_cast<std::size_t>(index)].weight_scale;
  const bool blocks_wanted = options.baselines.contains(Baseline::kLimit) || options.ablation;
  const MapPass pass = measureMap(
      map, side, openDecoders(map, index, candidates), subject, blocks_wanted,
      {isNormalMap(map.source->name, map.samples->shape().channels), blend_weights, pictures ? &*pictures : nullptr},
      buffers);
  MapEvaluation evaluation{summarize(map, pass, candidates, package.differences(), options, blend_weights),
                           pass.covered_texels, std::nullopt};
  if (pictures) {
    evaluation.pictures = finishPictures(map, pass, evaluation.map, *options.pictures, subject, *pictures);
  }
  return evaluation;
}

}  // namespace facezip::evaluate
