// compress.cpp - the FaceZip method from end to end. Each stage is a step of its own file; this one puts them in order.
#include "facezip/compress.hpp"

#include <fmt/format.h>
#include <sys/resource.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <memory>

#include "compress/band_plan.hpp"
#include "compress/difference_texture.hpp"
#include "compress/face.hpp"
#include "compress/gram.hpp"
#include "compress/kmeans.hpp"
#include "compress/map_bands.hpp"
#include "compress/map_set.hpp"
#include "compress/method_record.hpp"
#include "compress/permutation_solver.hpp"
#include "compress/seam_cost.hpp"
#include "compress/stage_clock.hpp"
#include "compress/texture_assignment.hpp"
#include "compress/weight_map.hpp"
#include "facezip/package.hpp"
#include "io/staged_directory.hpp"
#include "package/package_writer.hpp"
#include "raster/texel_masks.hpp"
#include "raster/weight_grid.hpp"

namespace facezip {
namespace {
using namespace compress;
namespace fs = std::filesystem;

constexpr int kCodeBits = 8;  // of a texel of a difference texture

void requireSaneOptions(const CompressOptions& options) {
  const auto require = [](bool holds, const char* option, const char* expected, const std::string& got) {
    if (!holds) throw InputError({option, "", expected, got, ""});
  };
  require(options.weight_scale >= 1 && options.weight_scale <= 64, "--weight-scale", "1 to 64",
          fmt::format("{}", options.weight_scale));
  require(options.differences >= 1 && options.differences <= 8, "--differences", "1 to 8",
          fmt::format("{}", options.differences));
  require(options.restarts >= 1, "--restarts", "at least 1", fmt::format("{}", options.restarts));
  require(options.cluster_restarts >= 1, "--cluster-restarts", "at least 1",
          fmt::format("{}", options.cluster_restarts));
  require(options.mask_cutoff >= 0.0 && options.mask_cutoff < 1.0, "--mask-cutoff", "0 or more and below 1",
          fmt::format("{}", options.mask_cutoff));
  require(!options.masks || *options.masks >= 1, "--masks", "at least 1", fmt::format("{}", options.masks.value_or(0)));
  require(!options.gutter || *options.gutter >= 0, "--gutter", "0 or more",
          fmt::format("{}", options.gutter.value_or(0)));
}

void widen(std::vector<TextureRange>& whole, const std::vector<TextureRange>& part) {
  if (whole.empty()) whole = part;
  for (std::size_t i = 0; i < whole.size(); ++i) {
    whole[i].min = std::min(whole[i].min, part[i].min);
    whole[i].max = std::max(whole[i].max, part[i].max);
  }
}

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
        buffers_(context_) {
    report_.device = device.info().name;
  }

  CompressReport run() {
    readGeometry();
    openTextures();
    const GramMatrices grams = accumulateGrams();
    assign(grams);
    writePackage();
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
    requireExpressionTopology(capture_, face_.mesh, progress_);
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

  // Textures, the weight grid, and how large a band may be.
  void openTextures() {
    maps_ = openMaps(capture_, face_, options_.weight_scale, options_.gutter);
    const raster::UvRaster& reference = *maps_.maps[maps_.reference].raster;
    progress_.stage("weight grid", 0);
    grid_ = raster::makeWeightGrid(*texel_masks_, reference, options_.weight_scale);
    clock_.book("weight grid");
    planBands();
    if (expressions() <= options_.differences) {
      progress_.note(fmt::format("{} expression{}: each gets a difference texture of its own", expressions(),
                                 expressions() == 1 ? "" : "s"));
    }
  }

  void planBands() {
    const std::uint64_t cells = grid_.cells.cells();
    const std::uint64_t resident = cells * static_cast<std::uint64_t>(expressions() * options_.differences) +
                                   grid_.cells.mask_index.size() * (sizeof(int) + sizeof(float)) + cells * sizeof(int);
    int rows = 0;
    std::uint64_t decoded = 0;
    for (const OpenMap& map : maps_.maps) {
      const BandCost cost = bandCost(bandShape(*map.samples, 0), options_.differences, report_.masks);
      const int planned =
          planBandRows(cost, map.samples->shape().height, options_.memory_bytes, resident, context_.info());
      rows = rows == 0 ? planned : std::min(rows, planned);
      decoded += map.samples->decodedBytes();
    }
    report_.band_rows = rows;
    keepDecoded(decoded);
  }

  /// Later passes read decoded samples from a scratch file beside the package where the disk has room for it.
  void keepDecoded(std::uint64_t decoded_bytes) {
    const fs::path directory = staged_.path();
    // Room for the package itself is kept free: it is never larger than the decoded textures.
    if (image::ScratchFile::freeBytes(directory) < 2 * decoded_bytes) {
      report_.decoded = "decoded again";
      progress_.note(
          fmt::format("no room for {} MB of decoded textures beside the package: decoding them in every pass",
                      decoded_bytes / 1000000));
      return;
    }
    report_.decoded = "scratch file";
    for (OpenMap& map : maps_.maps) map.samples->keepDecoded(directory);
  }

  void forEachBand(OpenMap& map, const std::string& stage, const std::function<void(const MapBand&)>& visit) {
    const auto make_tiles = [&](int begin, int end) { return texel_masks_->tiles(*map.raster, begin, end); };
    forEachMapBand(*map.samples, report_.band_rows, buffers_, make_tiles,
                   fmt::format("{}: {}", stage, map.source->name), progress_, visit);
  }

  GramSlots gramSlots() const {
    std::vector<bool> overlaps(static_cast<std::size_t>(report_.masks) * static_cast<std::size_t>(report_.masks),
                               false);
    const raster::UvRaster* last = nullptr;
    for (const OpenMap& map : maps_.maps) {
      if (map.raster.get() == last) continue;
      last = map.raster.get();
      for (int begin = 0; begin < last->height(); begin += report_.band_rows) {
        const int end = std::min(begin + report_.band_rows, last->height());
        raster::markOverlaps(texel_masks_->tiles(*last, begin, end), report_.masks, overlaps);
      }
    }
    return {report_.masks, raster::overlappingPairs(overlaps, report_.masks)};
  }

  // Pass 1: all that the search needs of the texels (Eq. 2 to 4).
  GramMatrices accumulateGrams() {
    GramAccumulator accumulator(context_, gramSlots(), expressions());
    clock_.book("overlaps");
    for (OpenMap& map : maps_.maps) {
      std::uint64_t covered = 0;
      forEachBand(map, "Gram matrices", [&](const MapBand& band) {
        accumulator.add(band.tiles, band.differences, band.shape, map.source->metric_weight);
        covered += static_cast<std::uint64_t>(
            std::count(band.masks.texel_weights.begin(), band.masks.texel_weights.end(), 1.0f));
      });
      if (&map == &maps_.maps.front()) report_.covered_texels = covered;
    }
    GramMatrices grams = accumulator.finish();
    report_.overlapping_pairs = static_cast<int>(grams.slots.pairs.size());
    clock_.book("Gram matrices");
    return grams;
  }

  // Clusters of every mask and their place in the textures: from here on no texel is touched.
  void assign(const GramMatrices& grams) {
    progress_.stage("clustering", 0);
    KmeansOptions kmeans;
    kmeans.clusters = options_.differences;
    kmeans.restarts = options_.cluster_restarts;
    kmeans.seed = options_.seed;
    const Clustering clustering = clusterFragments(context_, grams, kmeans);
    clock_.book("clustering");
    progress_.checkCancelled();
    progress_.stage("permutation", 0);
    const SeamTables tables = computeSeamTables(context_, grams, clustering);
    clock_.book("seam costs");
    const Permutation permutation = choosePermutation(tables);
    report_.permutation_cost = permutation.cost;
    coefficients_ = {report_.masks, options_.differences, expressions(),
                     differenceCoefficients(clustering, permutation)};
    texture_of_ = textureOfExpression(clustering, permutation);
    clock_.book("permutation");
    progress_.checkCancelled();
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

  // Pass 2: how far the difference textures reach, since 8 bits must hold them.
  std::vector<TextureEncoding> findEncoding(OpenMap& map, DifferenceTextures& textures) {
    std::vector<TextureRange> range;
    forEachBand(map, "range of the differences", [&](const MapBand& band) {
      if (band.masks.tiles.empty()) return;
      textures.compute(band.tiles, band.differences, band.shape);
      widen(range, textures.range(band.tiles, band.shape));
    });
    const auto count = static_cast<std::size_t>(options_.differences * map.samples->shape().channels);
    std::vector<TextureEncoding> encoding(count, TextureEncoding{0.0f, 0.0f});
    std::transform(range.begin(), range.end(), encoding.begin(),
                   [](const TextureRange& reach) { return encodingFor(reach, kCodeBits); });
    return encoding;
  }

  PackageMap describeMap(const OpenMap& map, const std::vector<TextureEncoding>& encoding) const {
    const image::ImageShape& shape = map.samples->shape();
    PackageMap described;
    described.name = map.source->name;
    described.width = shape.width;
    described.height = shape.height;
    described.channels = shape.channels;
    described.sample_type = shape.type;
    described.colour_space = map.source->colour_space;
    described.weight_scale = map.weight_scale;
    described.metric_weight = map.source->metric_weight;
    for (int i = 0; i < options_.differences; ++i) {
      PackageDifference difference;
      for (int c = 0; c < shape.channels; ++c) {
        const TextureEncoding& e = encoding[static_cast<std::size_t>(i * shape.channels + c)];
        difference.scale.push_back(e.scale);
        difference.offset.push_back(e.offset);
      }
      described.differences.push_back(std::move(difference));
    }
    return described;
  }

  // Pass 3: difference textures (Eq. 5) as bytes, beside the neutral as it is.
  void writeMap(package::PackageWriter& writer, int index, DifferenceTextures& textures,
                const std::vector<TextureEncoding>& encoding) {
    OpenMap& map = maps_.maps[static_cast<std::size_t>(index)];
    std::vector<std::uint8_t> codes;
    forEachBand(map, "writing", [&](const MapBand& band) {
      const int rows = band.end - band.begin;
      const std::size_t bytes =
          static_cast<std::size_t>(rows) * static_cast<std::size_t>(band.shape.width * band.shape.channels);
      codes.resize(bytes * static_cast<std::size_t>(options_.differences));
      textures.compute(band.tiles, band.differences, band.shape);
      textures.encode(band.tiles, band.shape, encoding, codes);
      const std::size_t neutral_bytes = static_cast<std::size_t>(rows) * map.samples->shape().rowBytes();
      tbb::parallel_for(-1, options_.differences, [&](int i) {
        if (i < 0) {
          writer.writeNeutralRows(index, band.samples.first(neutral_bytes), rows);
        } else {
          writer.writeDifferenceRows(
              index, i, std::as_bytes(std::span(codes)).subspan(static_cast<std::size_t>(i) * bytes, bytes), rows);
        }
      });
    });
  }

  // Weight maps (Eq. 6) of all expressions, on the grid that all maps share.
  void writeWeights(package::PackageWriter& writer) {
    progress_.stage("weight maps", 0);
    WeightMapper mapper(context_, texture_of_, report_.masks, expressions(), options_.differences);
    const std::size_t cells = grid_.cells.cells();
    std::vector<std::uint8_t> codes(mapper.outputBytes(cells));
    mapper.fill(grid_.cells, 0, cells, codes);
    writer.writeWeights(std::as_bytes(std::span(codes)));
    clock_.book("weight maps");
  }

  void writePackage() {
    DifferenceTextures textures(context_, coefficients_);
    PackageDescription description;
    description.name = capture_.name;
    description.expressions = capture_.expressions;
    description.differences = options_.differences;
    description.weights.scale.assign(static_cast<std::size_t>(options_.differences), 1.0 / 255.0);
    description.weights.offset.assign(static_cast<std::size_t>(options_.differences), 0.0);
    description.method_json = methodJson(options_, report_, face_.region_description);
    std::vector<std::vector<TextureEncoding>> encodings;
    for (OpenMap& map : maps_.maps) {
      encodings.push_back(findEncoding(map, textures));
      description.maps.push_back(describeMap(map, encodings.back()));
    }
    clock_.book("range of the differences");
    package::PackageWriter writer(std::move(description), staged_.path());
    writeWeights(writer);
    for (int m = 0; m < static_cast<int>(maps_.maps.size()); ++m) {
      writeMap(writer, m, textures, encodings[static_cast<std::size_t>(m)]);
    }
    writer.finish();
    clock_.book("writing");
  }

  std::uint64_t diskBytes() const {
    std::uint64_t bytes = 0;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(staged_.path())) {
      if (entry.is_regular_file()) bytes += entry.file_size();
    }
    return bytes;
  }

  const Capture& capture_;
  const CompressOptions& options_;
  device::DeviceContext& context_;
  Progress& progress_;
  io::StagedDirectory staged_;
  BandBuffers buffers_;
  StageClock clock_;
  CompressReport report_;
  Face face_;
  FaceMasks masks_;
  std::unique_ptr<raster::TexelMasks> texel_masks_;
  MapSet maps_;
  raster::WeightGrid grid_;
  TextureCoefficients coefficients_;
  std::vector<int> texture_of_;
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
