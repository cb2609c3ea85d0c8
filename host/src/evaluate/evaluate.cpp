#include "facezip/evaluate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "blend/band_blender.hpp"
#include "compress/band_plan.hpp"
#include "compress/face.hpp"
#include "compress/gram.hpp"
#include "compress/map_bands.hpp"
#include "compress/map_set.hpp"
#include "compress/method_record.hpp"
#include "compress/stage_clock.hpp"
#include "evaluate/pca.hpp"
#include "evaluate/squared_error.hpp"
#include "facezip/compress.hpp"
#include "io/staged_directory.hpp"
#include "raster/texel_masks.hpp"

namespace facezip {
namespace {
using namespace compress;
using namespace evaluate;
namespace fs = std::filesystem;

/// The capture's maps that the package has, in the package's order; refuses a package of another capture.
Capture matchingCapture(const Capture& capture, const Package& package) {
  const std::string file = (package.directory() / "package.json").string();
  if (capture.expressions != package.expressions()) {
    throw InputError(
        {file, "expressions",
         fmt::format("the {} expressions of {}, in its order", capture.expressions.size(), capture.directory.string()),
         fmt::format("{} expressions", package.expressions().size()), "evaluate against the capture it was made of"});
  }
  Capture matching = capture;
  matching.maps.clear();
  for (const PackageMap& map : package.maps()) {
    const auto found =
        std::find_if(capture.maps.begin(), capture.maps.end(), [&](const CaptureMap& m) { return m.name == map.name; });
    if (found == capture.maps.end()) {
      throw InputError({file, fmt::format("map \"{}\"", map.name),
                        fmt::format("a map of {}", capture.directory.string()), "none of that name", ""});
    }
    matching.maps.push_back(*found);
  }
  return matching;
}

void requireSameShape(const OpenMap& map, const PackageMap& packed, const Package& package) {
  const image::ImageShape& shape = map.samples->shape();
  const image::ImageShape got{packed.width, packed.height, packed.channels, packed.sample_type};
  if (shape == got) return;
  throw InputError({(package.directory() / "package.json").string(), fmt::format("map \"{}\"", packed.name),
                    fmt::format("{} x {}, {} channels as in the capture", shape.width, shape.height, shape.channels),
                    fmt::format("{} x {}, {} channels", got.width, got.height, got.channels),
                    "compress the capture again"});
}

/// Squared errors of one method on one map.
struct ErrorSums {
  std::string method;
  std::vector<double> per_expression;
};

MapErrors toErrors(const std::vector<double>& squared, double samples) {
  MapErrors errors;
  double sum = 0.0;
  for (const double value : squared) {
    sum += value;
    errors.per_expression.push_back(std::sqrt(value / samples));
  }
  errors.pooled = std::sqrt(sum / (samples * static_cast<double>(squared.size())));
  return errors;
}

/// A package of the same capture and settings whose clusters are not permuted, in a temporary directory.
class UnpermutedPackage {
 public:
  UnpermutedPackage(const Capture& capture, CompressOptions options, const EvaluateOptions& evaluation,
                    const Device& device, Progress& progress)
      : staged_(fs::temp_directory_path() / "facezip-no-permutation", io::StagedDirectory::Existing::kMerge) {
    options.method = CompressOptions::Method::kNoPermutation;
    options.memory_bytes = evaluation.memory_bytes;
    compressCapture(capture, staged_.path() / "package", options, device, progress);
    package_ = std::make_unique<Package>(Package::open(staged_.path() / "package"));
  }
  const Package& package() const { return *package_; }

 private:
  io::StagedDirectory staged_;  // never committed: the destructor removes it
  std::unique_ptr<Package> package_;
};

/// A package beside its name in the tables and its weights on the device.
struct Candidate {
  std::string method;
  const Package* package = nullptr;
  blend::WeightSets weights;
};

class Evaluator {
 public:
  Evaluator(const Capture& capture, const Package& package, const EvaluateOptions& options, const Device& device,
            Progress& progress)
      : capture_(matchingCapture(capture, package)),
        package_(package),
        options_(options),
        recorded_(optionsFromMethodJson(package.methodJson(), (package.directory() / "package.json").string())),
        device_(device),
        progress_(progress),
        buffers_(device.context()) {}

  Evaluation run() {
    evaluation_.expressions = package_.expressions();
    if (options_.no_permutation) {
      unpermuted_ = std::make_unique<UnpermutedPackage>(capture_, recorded_, options_, device_, progress_);
      candidates_.push_back({"no_permutation", &unpermuted_->package(), {}});
      clock_.book("compressing without permutation");
    }
    candidates_.push_back({"package", &package_, {}});
    for (Candidate& candidate : candidates_) candidate.weights = blend::loadWeightMaps(*candidate.package, device_);
    face_ = readFace(capture_, recorded_.region);
    maps_ = openMaps(capture_, face_, recorded_.weight_scale, 0);
    for (std::size_t m = 0; m < maps_.maps.size(); ++m) evaluateMap(static_cast<int>(m));
    countBytes();
    clock_.book("comparing");
    evaluation_.seconds = clock_.seconds();
    return evaluation_;
  }

 private:
  int expressions() const { return static_cast<int>(capture_.expressions.size()); }

  int bandRows(const OpenMap& map) const {
    const BandCost cost = bandCost(bandShape(*map.samples, 0), 2 * (package_.differences() + 1), 0);
    std::uint64_t cells = 0;
    for (const PackageWeights& grid : package_.weightSets())
      cells += static_cast<std::uint64_t>(grid.tile_width) * static_cast<std::uint64_t>(grid.tile_height);
    const auto weights = static_cast<std::uint64_t>(expressions()) * static_cast<std::uint64_t>(package_.differences());
    const std::uint64_t resident = cells * weights * candidates_.size();
    return planBandRows(cost, map.samples->shape().height, options_.memory_bytes, resident, device_.info());
  }

  void addErrors(blend::BandBlender& blender, const MapBand& band, std::vector<double>& sums) {
    blender.loadRows(band.begin, band.end);
    const std::size_t image_bytes = band.samples.size() / (static_cast<std::size_t>(expressions()) + 1);
    decoded_.resize(image_bytes);
    std::vector<float> beta(static_cast<std::size_t>(expressions()), 0.0f);
    for (std::size_t n = 0; n < beta.size(); ++n) {
      beta[n] = 1.0f;
      blender.blend(beta, decoded_);
      beta[n] = 0.0f;
      sums[n] +=
          squaredError(decoded_, band.samples.subspan((n + 1) * image_bytes, image_bytes), band.shape, band.masks);
    }
  }

  // One pass over a map: Gram matrix of its differences, and every package decoded beside the captured textures.
  void evaluateMap(int index) {
    OpenMap& map = maps_.maps[static_cast<std::size_t>(index)];
    std::vector<std::unique_ptr<blend::BandBlender>> blenders;
    std::vector<ErrorSums> sums;
    for (const Candidate& candidate : candidates_) {
      requireSameShape(map, candidate.package->maps()[static_cast<std::size_t>(index)], *candidate.package);
      blenders.push_back(std::make_unique<blend::BandBlender>(*candidate.package, index, candidate.weights, device_));
      sums.push_back({candidate.method, std::vector<double>(static_cast<std::size_t>(expressions()), 0.0)});
    }
    GramAccumulator accumulator(device_.context(), GramSlots{}, expressions());
    std::uint64_t covered = 0;
    const auto make_tiles = [&](int begin, int end) { return raster::coverageTiles(*map.raster, begin, end); };
    forEachMapBand(*map.samples, bandRows(map), buffers_, make_tiles, fmt::format("evaluating: {}", map.source->name),
                   progress_, [&](const MapBand& band) {
                     accumulator.add(band.tiles, band.differences, band.shape, 1.0);
                     covered += static_cast<std::uint64_t>(
                         std::count(band.masks.texel_weights.begin(), band.masks.texel_weights.end(), 1.0f));
                     for (std::size_t c = 0; c < blenders.size(); ++c)
                       addErrors(*blenders[c], band, sums[c].per_expression);
                   });
    if (index == 0) evaluation_.covered_texels = covered;
    const double samples = static_cast<double>(covered) * map.samples->shape().channels;
    addMap(map, accumulator.finish(), sums, samples);
  }

  void addMap(const OpenMap& map, const GramMatrices& grams, const std::vector<ErrorSums>& sums, double samples) {
    const Eigen::MatrixXd gram = grams.slot(grams.slots.whole());
    Evaluation::Map result;
    result.name = map.source->name;
    result.rms_difference = std::sqrt(gram.trace() / (samples * expressions()));
    if (options_.pca4) result.rmse["pca4"] = toErrors(pcaSquaredErrors(gram, 4), samples);
    if (options_.pca8) result.rmse["pca8"] = toErrors(pcaSquaredErrors(gram, 8), samples);
    for (const ErrorSums& sum : sums) result.rmse[sum.method] = toErrors(sum.per_expression, samples);
    evaluation_.maps.push_back(std::move(result));
  }

  void countBytes() {
    std::uint64_t textures = 0;  // one of every map
    for (const PackageMap& map : package_.maps()) textures += map.frameBytes();
    evaluation_.bytes["neutral"] = textures;
    evaluation_.bytes["raw"] = textures * (static_cast<std::uint64_t>(expressions()) + 1);
    if (options_.pca4) evaluation_.bytes["pca4"] = textures * 5;
    if (options_.pca8) evaluation_.bytes["pca8"] = textures * 9;
    if (options_.no_permutation) evaluation_.bytes["no_permutation"] = package_.bytesInMemory();
    evaluation_.bytes["package"] = package_.bytesInMemory();
    evaluation_.bytes["package_disk"] = package_.bytesOnDisk();
  }

  const Capture capture_;
  const Package& package_;
  const EvaluateOptions& options_;
  const CompressOptions recorded_;
  const Device& device_;
  Progress& progress_;
  BandBuffers buffers_;
  StageClock clock_;
  Face face_;
  MapSet maps_;
  std::unique_ptr<UnpermutedPackage> unpermuted_;
  std::vector<Candidate> candidates_;
  std::vector<std::byte> decoded_;
  Evaluation evaluation_;
};

}  // namespace

Evaluation evaluatePackage(const Capture& capture, const Package& package, const EvaluateOptions& options,
                           const Device& device, Progress& progress) {
  return Evaluator(capture, package, options, device, progress).run();
}

}  // namespace facezip
