// compress.cpp - the FaceZip method from end to end. Each stage is a step of its own file; this one puts them in order.
#include "facezip/compress.hpp"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <map>
#include <memory>
#include <stop_token>
#include <thread>

#include "compress/band_plan.hpp"
#include "compress/code_bits.hpp"
#include "compress/compress_options.hpp"
#include "compress/compress_stretch.hpp"
#include "compress/face.hpp"
#include "compress/face_guides.hpp"
#include "compress/gram.hpp"
#include "compress/importance.hpp"
#include "compress/kmeans.hpp"
#include "compress/map_bands.hpp"
#include "compress/map_set.hpp"
#include "compress/method_record.hpp"
#include "compress/package_output.hpp"
#include "compress/permutation_solver.hpp"
#include "compress/rate_search.hpp"
#include "compress/refinement.hpp"
#include "compress/seam_cost.hpp"
#include "compress/stage_clock.hpp"
#include "compress/texture_assignment.hpp"
#include "compress/texture_range.hpp"
#include "compress/texture_source.hpp"
#include "compress/weight_map.hpp"
#include "io/staged_directory.hpp"
#include "raster/texel_masks.hpp"
#include "raster/weight_grid.hpp"

namespace facezip {
namespace {
using namespace compress;
namespace fs = std::filesystem;

using Method = CompressOptions::Method;

/// Share of the weights at either end that may be clamped when they become bytes.
constexpr double kClippedWeights = 2e-4;

/// Maps that share weights, from their Gram matrices to what a package holds of them.
struct WeightGroup {
  std::vector<OpenMap*> maps;
  GramMatrices grams;
  TextureCoefficients coefficients;
  EncodedWeights start;                           ///< the paper's weights (Eq. 6)
  EncodedWeights weights;                         ///< that are written
  std::vector<std::vector<TextureRange>> ranges;  ///< of every map's difference textures
  std::vector<double> errors;                     ///< of every map: squared error before rounding, (1/255)^2
  double start_error = 0.0;                       ///< of all maps, with the start's weights, as the refinement saw it
};

std::uint64_t peakMemoryBytes() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;  // Linux counts in KiB
}

class Compression {
 public:
  Compression(const Capture& capture, const fs::path& package, const CompressOptions& options, const Device& device,
              Progress& progress)
      : capture_(capture),
        options_(options),
        context_(device.context()),
        progress_(progress),
        staged_(package, io::StagedDirectory::Existing::kReplaceMarked, "package.json"),
        buffers_(std::make_unique<BandBuffers>(context_)) {
    report_.device = device.info().name;
    if (options_.method == Method::kCompressStretch) options_.differences = kCompressStretchMaps;
  }

  CompressReport run() {
    openTextures();
    readGeometry();
    planBands();
    accumulateGrams();
    do {
      layGrid();
      for (WeightGroup& group : groups_) assign(group);
      grid_.cells = {};  // weights took their place
      solveAndWrite();
    } while (missesTarget());
    report_.differences = options_.differences;
    report_.weight_scale = options_.weight_scale;
    if (options_.mesh) {
      writeFaceMesh(capture_, face_, masks_.unit, expression_meshes_, staged_.path());
      clock_.book("mesh");
    }
    report_.package_disk_bytes = diskBytes();
    staged_.commit();
    clock_.book("publishing");
    for (const OpenMap& map : maps_.maps) {
      report_.wait_seconds += map.samples->waitSeconds();
      report_.decode_seconds += map.samples->decodeSeconds();
    }
    report_.seconds = clock_.seconds();
    report_.peak_memory_bytes = peakMemoryBytes();
    return report_;
  }

 private:
  int expressions() const { return static_cast<int>(capture_.expressions.size()); }

  // Mesh, region, samples, masks (FaceZip 3.1, "Mask Computation").
  void readGeometry() {
    progress_.stage("reading meshes", 0);
    face_ = readFace(capture_, options_.region);
    expression_meshes_ = readExpressionMeshes(capture_, face_.mesh, progress_);
    if (!options_.mesh) expression_meshes_.clear();
    const fs::path painted =
        options_.importance.empty() ? capture_.importance.value_or("") : fs::path(options_.importance);
    if (!painted.empty() && painted != "none") importance_.emplace(painted);
    clock_.book("meshes");
    masks_ = makeFaceMasks(capture_, face_, options_, progress_);
    report_.masks = masks_.masks.mask_count;
    report_.mask_radius = masks_.samples.radius;
    report_.unit = masks_.unit ? geometry::unitSymbol(*masks_.unit) : "";
    report_.unit_guessed = masks_.unit_guessed;
    report_.cut_mass_mean = masks_.masks.cost.mean_removed;
    report_.cut_mass_max = masks_.masks.cost.largest_removed;
    report_.active_masks_mean = masks_.masks.cost.mean_active_after;
    texel_masks_ = std::make_unique<raster::TexelMasks>(face_.mesh, masks_.region, masks_.masks);
    clock_.book("masks");
  }

  // Textures: from here on they are decoded beside the work.
  void openTextures() {
    maps_ = openMaps(capture_);
    if (!keepDecoded()) return;
    decoder_ = std::jthread([this](const std::stop_token& stop) {
      for (OpenMap& map : maps_.maps) map.samples->decode(stop);
    });
  }

  // How the maps lie on the face and on the weight grid, and how large a band may be.
  void planBands() {
    makeRasters(maps_, face_, options_.gutter);
    groups_.resize(options_.weights_per_map ? maps_.maps.size() : 1);
    for (std::size_t m = 0; m < maps_.maps.size(); ++m) {
      groups_[options_.weights_per_map ? m : 0].maps.push_back(&maps_.maps[m]);
    }
    for (const WeightGroup& group : groups_) assignFitWeights(group.maps);
    if (options_.target_rmse || options_.budget_bytes) {
      rates_ = std::make_unique<RateSearch>(options_, maps_, expressions(), weightSets());
      take(rates_->smallest());
    } else {
      assignWeightScales(maps_, options_.weight_scale);
    }
    report_.band_rows = plannedBandRows();
    clock_.book("weight grid");
  }

  // The weight grid: masks at its cells.
  void layGrid() {
    if (rates_) chooseRate();
    progress_.stage("weight grid", 0);
    grid_ = raster::makeWeightGrid(*texel_masks_, *maps_.maps[maps_.reference].raster, options_.weight_scale);
    guides_ = makeMaskGuides(face_, masks_, grid_);  // while the grid has its masks
    clock_.book("weight grid");
    if (expressions() <= options_.differences) {
      progress_.note(fmt::format("{} expression{}: each gets a difference texture of its own", expressions(),
                                 expressions() == 1 ? "" : "s"));
    }
  }

  // Takes the number of textures and the weight scale from the curve.
  void chooseRate() {
    const RatePoint chosen = rates_->choose([this](const RatePoint& point) {
      take(point);
      return fitsMemory();
    });
    take(chosen);
    report_.rate = chosen;
    report_.rate_curve = rates_->curve();
    report_.band_rows = plannedBandRows();
  }

  void take(const RatePoint& point) {
    options_.differences = point.differences;
    options_.weight_scale = point.weight_scale;
    assignWeightScales(maps_, point.weight_scale);
  }

  bool fitsMemory() const {
    try {
      plannedBandRows();
      for (const WeightGroup& group : groups_) plannedWindowRows(group);
      return true;
    } catch (const InputError&) {
      return false;
    }
  }

  /// True if the package that was written misses the target: the search then learns from it.
  bool missesTarget() {
    if (!rates_) return false;
    const double reached = pooledRmse();
    if (!rates_->misses(reached)) return false;
    progress_.note(fmt::format("{} differences with weights at 1/{} reach {:.3f}, not {:.3f}: trying more",
                               options_.differences, options_.weight_scale, reached, *options_.target_rmse));
    return true;
  }

  /// Of all maps as written, metric weights in it.
  double pooledRmse() const {
    double error = 0.0;
    double samples = 0.0;
    for (std::size_t m = 0; m < maps_.maps.size(); ++m) {
      const OpenMap& map = maps_.maps[m];
      const double weight = map.metric_weight * coveredTexels(map) * map.samples->shape().channels;
      error += weight * report_.rmse[m].second * report_.rmse[m].second;
      samples += weight;
    }
    return std::sqrt(error / samples);
  }

  /// Known before the grid is laid.
  WeightSpace weightSpace() const {
    const image::ImageShape& shape = maps_.maps[maps_.reference].samples->shape();
    const auto cells = [this](int side) { return (side + options_.weight_scale - 1) / options_.weight_scale; };
    return {cells(shape.width), cells(shape.height), options_.differences, expressions()};
  }

  int weightSets() const { return static_cast<int>(groups_.size()); }

  /// What stays from pass to pass: weights of every set as codes, at the start and as written, one as halves while it
  /// is refined, and the masks of the cells.
  std::uint64_t residentBytes() const {
    constexpr std::uint64_t kMasksOfACell = 8;
    const WeightSpace space = weightSpace();
    const std::uint64_t cells = static_cast<std::uint64_t>(space.columns) * static_cast<std::uint64_t>(space.rows);
    return cells * (static_cast<std::uint64_t>(expressions() * options_.differences * (2 * weightSets() + 2)) +
                    kMasksOfACell * (sizeof(int) + sizeof(float)) + sizeof(int));
  }

  /// Rows of a band that all maps can have. Throws InputError where --memory is too little.
  int plannedBandRows() const {
    int rows = 0;
    for (const OpenMap& map : maps_.maps) {
      const BandCost cost = bandCost(bandShape(*map.samples, 0), options_.differences, report_.masks);
      const int planned =
          planBandRows(cost, map.samples->shape().height, options_.memory_bytes, residentBytes(), context_.info());
      rows = rows == 0 ? planned : std::min(rows, planned);
    }
    return rows;
  }

  /// The same of the windows of the refinement, in rows of cells.
  int plannedWindowRows(const WeightGroup& group) const {
    return planWindowRows(group.maps, weightSpace(), sweepsHalfCells(context_, group.maps), options_.memory_bytes,
                          residentBytes(), context_.info());
  }

  /// Textures are decoded once, into a scratch file beside the package, where the disk has room for it: true then.
  bool keepDecoded() {
    std::uint64_t decoded_bytes = 0;
    for (const OpenMap& map : maps_.maps) decoded_bytes += map.samples->decodedBytes();
    const fs::path directory = staged_.path();
    // Room for the package itself is kept free: it is never larger than the decoded textures.
    if (image::ScratchFile::freeBytes(directory) < 2 * decoded_bytes) {
      report_.decoded = "decoded again";
      progress_.note(
          fmt::format("no room for {} MB of decoded textures beside the package: decoding them in every pass",
                      decoded_bytes / 1000000));
      return false;
    }
    report_.decoded = "scratch file";
    for (OpenMap& map : maps_.maps) map.samples->keepDecoded(directory);
    return true;
  }

  void forEachBand(OpenMap& map, const std::string& stage, const MakeTiles& make_tiles,
                   const std::function<void(const MapBand&)>& visit) {
    forEachMapBand(*map.samples, report_.band_rows, *buffers_, make_tiles,
                   fmt::format("{}: {}", stage, map.source->name), progress_, visit);
  }

  void forEachBand(OpenMap& map, const std::string& stage, const TextureSource& source,
                   const std::function<void(const MapBand&)>& visit) {
    forEachBand(
        map, stage, [&](int begin, int end) { return source.tiles(map, begin, end); }, visit);
  }

  /// Puts the painted importance into the texel weights.
  TileMasks weighed(TileMasks tiles, const OpenMap& map, int first_row) const {
    const image::ImageShape& shape = map.samples->shape();
    if (importance_) importance_->apply(tiles, shape.width, shape.height, first_row);
    return tiles;
  }

  // Pass 1: all that the search needs of the texels (Eq. 2 to 4).
  void accumulateGrams() {
    const GramSlots slots{report_.masks, texel_masks_->overlappingPairs()};
    covered_texels_.assign(maps_.maps.size(), 0);
    for (WeightGroup& group : groups_) {
      GramAccumulator accumulator(context_, slots, expressions());
      for (OpenMap* map : group.maps) {
        std::uint64_t covered = 0;
        const auto make_tiles = [&](int begin, int end) {
          return weighed(texel_masks_->tiles(*map->raster, begin, end, raster::TexelMasks::Texels::kCovered), *map,
                         begin);
        };
        forEachBand(*map, "Gram matrices", make_tiles, [&](const MapBand& band) {
          accumulator.add(band.tiles, band.differences, band.shape, map->fit_weight);
          if (rates_) rates_->estimate().addBand(static_cast<std::size_t>(map - maps_.maps.data()), band);
          covered +=
              static_cast<std::uint64_t>(std::count_if(band.masks.texel_weights.begin(), band.masks.texel_weights.end(),
                                                       [](float weight) { return weight > 0.0f; }));
        });
        covered_texels_[static_cast<std::size_t>(map - maps_.maps.data())] = covered;
      }
      group.grams = accumulator.finish();
    }
    if (rates_) lookAgain();
    report_.covered_texels = covered_texels_.front();
    report_.overlapping_pairs = static_cast<int>(slots.pairs.size());
    clock_.book("Gram matrices");
  }

  // A change that the sample of a map's texels missed altogether leaves nothing to estimate by.
  void lookAgain() {
    for (std::size_t m = 0; m < maps_.maps.size(); ++m) {
      if (!rates_->estimate().sawNothing(m)) continue;
      rates_->estimate().startOver(m);
      OpenMap& map = maps_.maps[m];
      const auto make_tiles = [&](int begin, int end) { return raster::coverageTiles(*map.raster, begin, end); };
      forEachBand(map, "estimating", make_tiles, [&](const MapBand& band) { rates_->estimate().addBand(m, band); });
    }
  }

  // Clusters of every mask and their place in the textures, and the weights that follow (Eq. 6). Touches no texel.
  void assign(WeightGroup& group) {
    if (options_.method == Method::kCompressStretch) {
      assignInfluences(group);
      return;
    }
    progress_.stage("clustering", 0);
    KmeansOptions kmeans;
    kmeans.clusters = options_.differences;
    kmeans.restarts = options_.cluster_restarts;
    kmeans.seed = options_.seed;
    const Clustering clustering = clusterFragments(context_, group.grams, kmeans);
    clock_.book("clustering");
    progress_.checkCancelled();
    progress_.stage("permutation", 0);
    const SeamTables tables = computeSeamTables(context_, group.grams, clustering);
    clock_.book("seam costs");
    const Permutation permutation = choosePermutation(tables);
    report_.permutation_cost = permutation.cost;
    group.coefficients = {report_.masks, options_.differences, expressions(),
                          differenceCoefficients(clustering, permutation)};
    clock_.book("permutation");
    progress_.checkCancelled();
    progress_.stage("weight maps", 0);
    const std::vector<int> texture_of = textureOfExpression(clustering, permutation);
    WeightMapper mapper(context_, texture_of, report_.masks, expressions(), options_.differences);
    const std::size_t cells = grid_.cells.cells();
    group.start.scale.assign(static_cast<std::size_t>(options_.differences), 1.0 / 255.0);
    group.start.offset.assign(static_cast<std::size_t>(options_.differences), 0.0);
    group.start.codes.resize(mapper.outputBytes(cells));
    mapper.fillAll(grid_.cells, group.start.codes);
    clock_.book("weight maps");
  }

  // Li et al. 2020, Eq. 10 to 12: the weights follow from the meshes alone.
  void assignInfluences(WeightGroup& group) {
    progress_.stage("influences", 0);
    group.start = normalisedInfluences(
        face_.mesh,
        vertexInfluences(face_.mesh,
                         readExpressionMeshes(capture_, face_.mesh, "its mesh, for its influence", progress_)),
        *maps_.maps[maps_.reference].raster, options_.weight_scale);
    clock_.book("influences");
  }

  /// Difference textures that follow from the weights as they are.
  std::unique_ptr<TextureSource> directTextures(const WeightGroup& group) {
    if (options_.method == Method::kCompressStretch) {
      return std::make_unique<CompressStretchTextures>(context_, weightSpace(), group.start);
    }
    return std::make_unique<ClusterTextures>(context_, *texel_masks_, group.coefficients);
  }

  Permutation choosePermutation(const SeamTables& tables) {
    if (options_.method == CompressOptions::Method::kNoPermutation) return identityPermutation(tables);
    PermutationSolverOptions solver;
    solver.solver = options_.permutation_solver;
    solver.descent.restarts = options_.restarts;
    solver.descent.seed = options_.seed;
    const PermutationSolution found = solvePermutation(tables, solver);
    report_.permutation_solver = found.by_descent ? "descent" : "message-passing";
    report_.permutation_bound = found.bound;
    report_.permutation_bounds = found.bounds;
    report_.convergence = found.descent.sweep_costs;
    report_.restart_costs = found.descent.finalCosts();
    if (!report_.restart_costs.empty()) report_.permutation_cost_median = found.descent.medianFinalCost();
    return found.best;
  }

  // Pass 2 of the paper's method: how far the difference textures reach, since their codes must hold them.
  void solvePaper(WeightGroup& group) {
    const std::unique_ptr<TextureSource> source = directTextures(group);
    TextureRangeFinder finder(context_, options_.differences);
    group.weights = group.start;
    group.ranges.assign(group.maps.size(), {});
    for (std::size_t m = 0; m < group.maps.size(); ++m) {
      OpenMap& map = *group.maps[m];
      forEachBand(map, "range of the differences", *source, [&](const MapBand& band) {
        const cl::Buffer& textures = source->compute(map, band);
        widen(group.ranges[m], finder.find(band.tiles, band.shape, textures, 0, band.tiles.tileCount()));
      });
    }
    clock_.book("range of the differences");
  }

  // Pass 2 of the other methods: weights and difference textures fitted in turn.
  void solveFitted(WeightGroup& group, int most_sweeps) {
    RefinementOptions refinement;
    refinement.most_sweeps = most_sweeps;
    RefinementProblem problem{weightSpace(), group.start, group.maps, {}, cellEnergy(group), 0};
    problem.make_tiles = [this](const OpenMap& map, int begin, int end) {
      return weighed(raster::activeTiles(*map.raster, begin, end), map, begin);
    };
    buffers_ = std::make_unique<BandBuffers>(context_);
    problem.window_rows = plannedWindowRows(group);
    Refinement refined = refine(context_, problem, refinement, progress_);
    group.ranges = std::move(refined.ranges);
    group.errors = std::move(refined.end_errors);
    group.start_error = refined.errors.front();
    if (most_sweeps > 0) {
      report_.refinement_errors = std::move(refined.errors);
      group.weights = refined.weights.encode(grid_.covered, kClippedWeights);
    } else {
      group.weights = group.start;
    }
    clock_.book("refining");
  }

  /// Mean energy of an expression's differences on a covered cell: what smoothness and trust are measured by.
  double cellEnergy(const WeightGroup& group) const {
    const double energy = group.grams.slot(group.grams.slots.whole()).trace() / expressions();
    const auto cells = static_cast<double>(std::count(grid_.covered.begin(), grid_.covered.end(), 1));
    return energy > 0.0 ? energy / std::max(cells, 1.0) : 1.0;
  }

  void solveAndWrite() {
    switch (options_.method) {
      case Method::kPaper:
      case Method::kNoPermutation:
      case Method::kCompressStretch:
        for (WeightGroup& group : groups_) solvePaper(group);
        write();
        return;
      case Method::kClosedLoop:
        for (WeightGroup& group : groups_) solveFitted(group, 0);
        write();
        return;
      case Method::kRefined:
        refineAndWrite();
        return;
    }
  }

  /// Writes refined weights, but where rounding made those of a group worse than the paper's with textures that suit
  /// them it keeps the paper's: that can only be where they are exact or nearly so.
  void refineAndWrite() {
    // As many textures as expressions: the start is exact already.
    const int sweeps = expressions() <= options_.differences ? 0 : RefinementOptions{}.most_sweeps;
    report_.refinement_errors.clear();
    for (WeightGroup& group : groups_) solveFitted(group, sweeps);
    const std::vector<double> refined_errors = write();
    constexpr double kSuspicious = 0.5;          // of the start's error; refinement commonly leaves a third
    std::map<std::size_t, WeightGroup> refined;  // that may be worse than the start
    for (std::size_t g = 0; sweeps > 0 && g < groups_.size(); ++g) {
      if (refined_errors[g] > kSuspicious * groups_[g].start_error) refined[g] = groups_[g];
    }
    if (refined.empty()) return;
    for (const auto& [g, group] : refined) solveFitted(groups_[g], 0);
    const std::vector<double> start_errors = write();
    std::erase_if(refined, [&](const auto& entry) { return start_errors[entry.first] <= refined_errors[entry.first]; });
    for (auto& [g, group] : refined) groups_[g] = std::move(group);
    if (refined.empty()) {
      progress_.note("the paper's weights are exact here: they are kept");
    } else {
      write();
    }
  }

  /// Pass 3: writes what the groups hold. Returns the squared error of every group, fit weights in it, where difference
  /// textures were fitted.
  std::vector<double> write() {
    PackageSolution solution;
    solution.differences = options_.differences;
    solution.method_json = methodJson(options_, report_, face_.region_description);
    solution.has_mesh = options_.mesh;
    solution.guides = guides_;
    std::vector<std::unique_ptr<TextureSource>> sources;
    struct Fitted {
      FittedTextures* source;
      OpenMap* map;
      std::size_t group;
    };
    std::vector<Fitted> fitted;
    const bool paper = options_.method != Method::kClosedLoop && options_.method != Method::kRefined;
    solution.maps.resize(maps_.maps.size());  // in the capture's order; their addresses stay
    for (std::size_t g = 0; g < groups_.size(); ++g) {
      const WeightGroup& group = groups_[g];
      solution.weights.push_back(group.weights);
      for (std::size_t m = 0; m < group.maps.size(); ++m) {
        OpenMap& map = *group.maps[m];
        MapSolution& out = solution.maps[static_cast<std::size_t>(&map - maps_.maps.data())];
        out = {&map, static_cast<int>(g), {}, 8, nullptr};
        if (!paper) out.bits = bitsOf(group, m);
        for (const TextureRange& range : group.ranges[m]) out.encoding.push_back(encodingFor(range, out.bits));
        if (paper) {
          sources.push_back(directTextures(group));
        } else {
          auto source =
              std::make_unique<FittedTextures>(context_, weightSpace(), group.weights,
                                               ridgeOf(RefinementOptions{}, weightSpace()), out.encoding, out.bits);
          fitted.push_back({source.get(), &map, g});
          sources.push_back(std::move(source));
        }
        out.source = sources.back().get();
      }
    }
    const auto pass = [this](OpenMap& map, TextureSource& source, const std::function<void(const MapBand&)>& visit) {
      forEachBand(map, "writing", source, visit);
    };
    staged_.clear();  // an attempt before may have had more textures
    compress::writePackage(context_, capture_, solution, pass, staged_.path());
    clock_.book("writing");
    std::vector<double> errors(groups_.size(), 0.0);
    report_.rmse.clear();
    for (const auto& [source, map, group] : fitted) {
      errors[group] += map->fit_weight * source->squaredError();
      const double samples = coveredTexels(*map) * map->samples->shape().channels * expressions();
      report_.rmse.emplace_back(map->source->name, std::sqrt(source->squaredError() / samples));
    }
    return errors;
  }

  int bitsOf(const WeightGroup& group, std::size_t m) const {
    const SampleType type = group.maps[m]->samples->shape().type;
    // What was chosen was chosen for its size: its bits are kept to.
    if (report_.rate) return type == SampleType::kUint8 ? 8 : report_.rate->code_bits;
    return codeBits(codeError(group, m), group.errors[m], type);
  }

  /// Squared error that 8-bit codes of a map's difference textures would add.
  double codeError(const WeightGroup& group, std::size_t m) const {
    const std::vector<double> weights = meanSquares(group.weights, weightSpace(), grid_.covered);
    return codeSquaredError(group.ranges[m], weights) * coveredTexels(*group.maps[m]) * expressions();
  }

  double coveredTexels(const OpenMap& map) const {
    return static_cast<double>(covered_texels_[static_cast<std::size_t>(&map - maps_.maps.data())]);
  }

  std::uint64_t diskBytes() const {
    std::uint64_t bytes = 0;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(staged_.path())) {
      if (entry.is_regular_file()) bytes += entry.file_size();
    }
    return bytes;
  }

  const Capture& capture_;
  CompressOptions options_;  ///< differences and weight_scale may be chosen on the way
  device::DeviceContext& context_;
  Progress& progress_;
  io::StagedDirectory staged_;
  std::unique_ptr<BandBuffers> buffers_;  ///< of passes; made anew where something else needs the memory between
  StageClock clock_;
  CompressReport report_;
  Face face_;
  std::vector<Eigen::MatrixX3f> expression_meshes_;  ///< N, some of 0 rows; empty where they are not kept
  FaceMasks masks_;
  std::unique_ptr<raster::TexelMasks> texel_masks_;
  MapSet maps_;
  raster::WeightGrid grid_;
  MaskGuides guides_;
  std::optional<Importance> importance_;
  std::unique_ptr<RateSearch> rates_;  ///< where a target or budget was given
  std::vector<WeightGroup> groups_;
  std::vector<std::uint64_t> covered_texels_;  ///< of every map
  std::jthread decoder_;                       ///< reads what the members above hold: the first to go
};

}  // namespace

double CompressReport::permutationGap() const {
  if (!permutation_bound || permutation_cost <= 0.0) return 0.0;
  return (permutation_cost - *permutation_bound) / permutation_cost;
}

CompressReport compressCapture(const Capture& capture, const fs::path& package, const CompressOptions& options,
                               const Device& device, Progress& progress) {
  requireSaneOptions(options);
  return Compression(capture, package, options, device, progress).run();
}

}  // namespace facezip
