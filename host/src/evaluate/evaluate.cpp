#include "facezip/evaluate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "compress/bands/covered_texels.hpp"
#include "compress/bands/map_bands.hpp"
#include "compress/rate/block_rank_energy.hpp"
#include "compress/search/gram.hpp"
#include "compress/stage_clock.hpp"
#include "evaluate/ablation.hpp"
#include "evaluate/baseline_packages.hpp"
#include "evaluate/blend_error.hpp"
#include "evaluate/error_pictures.hpp"
#include "evaluate/map_measurement.hpp"
#include "evaluate/normal_angle.hpp"
#include "evaluate/pca.hpp"
#include "evaluate/subject.hpp"
#include "evaluate/texel_errors.hpp"
#include "raster/texel_masks.hpp"

namespace facezip {
namespace {
using namespace compress;
using namespace evaluate;

/// A package beside its name in the tables.
struct Candidate {
  std::string method;
  std::unique_ptr<TemporaryPackage> temporary;  ///< none for the package that is evaluated
  std::unique_ptr<PackageDecoder> decoder;
};

/// What one pass over a map's textures finds.
struct MapPass {
  GramMatrices grams;
  RankEnergy limit;
  std::vector<PackageErrors> errors;  ///< of each candidate
  double samples = 0.0;               ///< covered texels x channels
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

class Evaluator {
 public:
  Evaluator(const Capture& capture, const Package& package, const EvaluateOptions& options, const Device& device,
            Progress& progress)
      : package_(package),
        options_(options),
        subject_(makeSubject(capture, package, options.memory_bytes, options.shapes, device, progress)),
        own_names_({methodKey(subject_.recorded.method)}),
        picture_map_(options.picture_map.empty() ? 0 : package.mapIndex(options.picture_map)),
        buffers_(device.context()) {}

  Evaluation run() {
    evaluation_.method = own_names_.front();
    evaluation_.differences = package_.differences();
    evaluation_.expressions = subject_.capture.expressions;
    evaluation_.blend_weights = randomWeightVectors(subject_.recorded.seed, options_.blends, subject_.expressions());
    makeCandidates();
    evaluateMaps();
    countBytes();
    clock_.book("comparing");
    candidates_.clear();
    if (options_.ablation) {
      addAblation(subject_, evaluation_);
      clock_.book("ablation");
    }
    if (!options_.mask_sweep.empty()) {
      addMaskSweep(subject_, options_.mask_sweep, evaluation_);
      clock_.book("mask sweep");
    }
    evaluation_.seconds = clock_.seconds();
    return evaluation_;
  }

 private:
  using Method = CompressOptions::Method;

  void makeCandidates() {
    candidates_.push_back({"package", nullptr, std::make_unique<PackageDecoder>(package_, subject_.device)});
    candidates_.back().decoder->setExpressions(subject_.as_packed);
    if (!subject_.as_rigged.empty()) {
      candidates_.push_back({"rig", nullptr, std::make_unique<PackageDecoder>(package_, subject_.device)});
      candidates_.back().decoder->setExpressions(subject_.as_rigged);
    }
    if (options_.no_permutation) addCandidate(Method::kNoPermutation);
    if (options_.paper) addCandidate(Method::kPaper);
    if (options_.compress_stretch) addCandidate(Method::kCompressStretch);
    if (options_.closed_loop) addCandidate(Method::kClosedLoop);
    if (options_.refined) addCandidate(Method::kRefined);
    if (options_.weights_per_map) addWeightsPerMap();
  }

  void addCandidate(Method method) {
    if (method == subject_.recorded.method) return;  // the package itself
    CompressOptions options = subject_.recorded;
    options.method = method;
    addCandidate(methodKey(method), options);
  }

  void addWeightsPerMap() {
    const std::string key = "weights_per_map";
    if (package_.maps().size() == package_.weightSets().size()) {
      own_names_.push_back(key);
      return;
    }
    CompressOptions options = subject_.recorded;
    options.weights_per_map = true;
    addCandidate(key, options);
  }

  void addCandidate(const std::string& key, const CompressOptions& options) {
    auto temporary =
        std::make_unique<TemporaryPackage>(subject_.capture, options, key, subject_.device, subject_.progress);
    const CompressReport& report = temporary->report();
    if (!report.convergence.empty() && !evaluation_.search) {
      evaluation_.search = PermutationSearch{report.permutation_cost, report.permutation_bound, report.convergence};
    }
    auto decoder = std::make_unique<PackageDecoder>(temporary->package(), subject_.device);
    candidates_.push_back({key, std::move(temporary), std::move(decoder)});
    clock_.book("compressing: " + key);
  }

  void evaluateMaps() {
    MapSet maps = openMaps(subject_);
    for (std::size_t m = 0; m < maps.maps.size(); ++m) {
      std::optional<PictureCollector> pictures;
      const bool all = options_.pictures_of_all_maps && options_.picture_map.empty();
      if (options_.pictures && (all || static_cast<int>(m) == picture_map_))
        pictures.emplace(collectorOf(maps.maps[m]));
      const MapPass pass = measureMap(maps.maps[m], static_cast<int>(m), pictures ? &*pictures : nullptr);
      addMap(maps.maps[m], pass);
      if (pictures) finishPictures(maps.maps[m], pass, *pictures);
    }
  }

  std::vector<PackageDecoder*> openDecoders(const OpenMap& map, int index) {
    std::vector<PackageDecoder*> decoders;
    for (Candidate& candidate : candidates_) {
      const Package& package = candidate.decoder->package();
      requireSameShape(map, package.maps()[static_cast<std::size_t>(index)], package);
      candidate.decoder->openMap(index);
      decoders.push_back(candidate.decoder.get());
    }
    return decoders;
  }

  // One pass over a map: Gram matrices of its differences and of its blocks', and every package decoded beside it.
  MapPass measureMap(OpenMap& map, int index, PictureCollector* pictures) {
    const image::ImageShape& shape = map.samples->shape();
    const auto count = static_cast<std::uint64_t>(subject_.expressions());
    const std::vector<PackageDecoder*> decoders = openDecoders(map, index);
    MapMeasurement measurement(decoders, subject_.expressions(),
                               {isNormalMap(map.source->name, shape.channels), evaluation_.blend_weights, pictures});
    GramAccumulator accumulator(subject_.device.context(), GramSlots{}, subject_.expressions());
    const int side = package_.maps()[static_cast<std::size_t>(index)].weight_scale;
    BlockRankEnergy blocks({side}, shape.width, shape.height, shape.channels, subject_.expressions());
    const auto block_row = static_cast<std::uint64_t>(shape.width / side + 1) * count * count * 8;
    const int rows = bandRows(subject_, map, decoders, block_row + (pictures ? pictures->bytes() : 0));
    std::uint64_t covered = 0;
    const auto make_tiles = [&](int begin, int end) { return raster::coverageTiles(*map.raster, begin, end); };
    forEachMapBand(*map.samples, rows, buffers_, make_tiles, fmt::format("evaluating: {}", map.source->name),
                   subject_.progress, [&](const MapBand& band) {
                     const auto texels = coveredTexels(band.shape, band.masks);
                     covered += texels.size();
                     accumulator.add(band.tiles, band.differences, band.shape, 1.0);
                     if (options_.limit || options_.ablation)
                       blocks.addBand(band.begin, band.samples, band.shape, texels);
                     measurement.addBand(band.begin, band.end, band.samples, band.shape, texels);
                   });
    if (index == 0) evaluation_.covered_texels = covered;
    return {accumulator.finish(), blocks.energies().front(), measurement.errors(),
            static_cast<double>(covered) * shape.channels};
  }

  static Eigen::MatrixXd gramOf(const MapPass& pass) { return pass.grams.slot(pass.grams.slots.whole()); }

  void addMap(const OpenMap& map, const MapPass& pass) {
    const Eigen::MatrixXd gram = gramOf(pass);
    Evaluation::Map result;
    result.name = map.source->name;
    result.rms_difference = std::sqrt(gram.trace() / (pass.samples * subject_.expressions()));
    if (options_.pca4) result.rmse["pca4"] = pcaErrors(gram, 4, pass.samples);
    if (options_.pca8) result.rmse["pca8"] = pcaErrors(gram, 8, pass.samples);
    if (options_.limit) result.rmse["limit"] = {limitError(pass, package_.differences()), {}};
    for (std::size_t c = 0; c < candidates_.size(); ++c) {
      addDecoded(candidates_[c].method, pass.errors[c], result);
      if (candidates_[c].method != "package") continue;
      for (const std::string& name : own_names_) addDecoded(name, pass.errors[c], result);
    }
    if (options_.ablation) addUndecodedAblation(pass, gram, result);
    evaluation_.maps.push_back(std::move(result));
  }

  double limitError(const MapPass& pass, int components) const {
    const double residual = pass.limit.residual[static_cast<std::size_t>(components)];
    return std::sqrt(residual / (pass.samples * subject_.expressions()));
  }

  void addDecoded(const std::string& method, const PackageErrors& errors, Evaluation::Map& result) const {
    const auto detail = pooledAndEach(errors.pooledTexels(), errors.texels, summarizeTexelErrors);
    MapErrors& rmse = result.rmse[method];
    rmse.pooled = detail.pooled.rmse;
    for (const TexelErrors& each : detail.per_expression) rmse.per_expression.push_back(each.rmse);
    result.detail[method] = detail;
    if (!errors.angles.empty()) {
      result.angles[method] = pooledAndEach(errors.pooledAngles(), errors.angles, summarizeNormalAngles);
    }
    if (!errors.blends.empty()) {
      result.blends[method] = summarizeBlendErrors(errors.blends, evaluation_.blend_weights, errors.texels);
    }
  }

  void addUndecodedAblation(const MapPass& pass, const Eigen::MatrixXd& gram, Evaluation::Map& result) const {
    for (int components = 1; components <= kMostAblated; ++components) {
      result.ablation["limit"][components] = limitError(pass, components);
      result.ablation["pca"][components] = pcaErrors(gram, components, pass.samples).pooled;
    }
    result.ablation["pca"][8] = pcaErrors(gram, 8, pass.samples).pooled;
  }

  PictureCollector collectorOf(const OpenMap& map) const {
    std::vector<int> columns;
    std::vector<std::string> methods;
    for (const Candidate& candidate : candidates_) {
      const bool shown = candidate.method == "package" || (options_.picture_baselines && candidate.method == "paper");
      columns.push_back(shown ? static_cast<int>(methods.size()) : -1);
      if (shown) methods.push_back(candidate.method);
    }
    if (options_.picture_baselines && options_.pca4) methods.emplace_back("pca4");
    return {map.source->name, map.samples->shape(), subject_.expressions(), columns, methods, options_.picture_side};
  }

  // PCA's components are known only now: its errors take another pass over the map.
  void finishPictures(OpenMap& map, const MapPass& pass, PictureCollector& pictures) {
    double largest_p99 = 0.0;
    for (const char* method : {"package", "paper"}) {
      if (!options_.picture_baselines && method != std::string_view("package")) continue;
      const auto found = evaluation_.maps.back().detail.find(method);
      if (found != evaluation_.maps.back().detail.end()) largest_p99 = std::max(largest_p99, found->second.pooled.p99);
    }
    const Eigen::MatrixXd projector = pcaProjector(gramOf(pass), 4);
    if (pictures.wantsPca()) {
      subject_.progress.stage(fmt::format("picture: {}", map.source->name),
                              static_cast<std::size_t>(map.samples->shape().height));
      const int rows = bandRows(subject_, map, {}, pictures.bytes());
      map.samples->forEachBand(rows, subject_.progress, [&](const image::SampleBand& band) {
        const BandShape shape = bandShape(*map.samples, band.end - band.begin);
        const auto texels = coveredTexels(shape, raster::coverageTiles(*map.raster, band.begin, band.end));
        pictures.addPca(band.begin, band.samples, shape, texels, projector);
        subject_.progress.advance(static_cast<std::size_t>(band.end));
      });
    }
    evaluation_.pictures.push_back(pictures.finish(largest_p99, projector));
  }

  void countBytes() {
    std::uint64_t textures = 0;  // one of every map
    for (const PackageMap& map : package_.maps()) textures += map.frameBytes();
    evaluation_.bytes["neutral"] = textures;
    evaluation_.bytes["raw"] = textures * (static_cast<std::uint64_t>(subject_.expressions()) + 1);
    // There are no more components than expressions.
    const auto pca = [&](int components) {
      return textures * (static_cast<std::uint64_t>(std::min(components, subject_.expressions())) + 1);
    };
    if (options_.pca4) evaluation_.bytes["pca4"] = pca(4);
    if (options_.pca8) evaluation_.bytes["pca8"] = pca(8);
    for (const Candidate& candidate : candidates_) {
      evaluation_.bytes[candidate.method] = candidate.decoder->package().bytesInMemory();
    }
    for (const std::string& name : own_names_) evaluation_.bytes[name] = package_.bytesInMemory();
    evaluation_.bytes["package_disk"] = package_.bytesOnDisk();
    if (!options_.ablation) return;
    for (const int components : {1, 2, 3, 4, 8}) {
      evaluation_.ablation_bytes["pca"][components] = pca(components);
    }
  }

  const Package& package_;
  const EvaluateOptions& options_;
  const Subject subject_;
  std::vector<std::string> own_names_;  ///< under which the package is known too: its method's first
  const int picture_map_;
  BandBuffers buffers_;
  StageClock clock_;
  std::vector<Candidate> candidates_;
  Evaluation evaluation_;
};

}  // namespace

Evaluation evaluatePackage(const Capture& capture, const Package& package, const EvaluateOptions& options,
                           const Device& device, Progress& progress) {
  return Evaluator(capture, package, options, device, progress).run();
}

}  // namespace facezip
