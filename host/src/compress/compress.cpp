// compress.cpp - the FaceZip method from end to end. Each stage is a function of its own file; this one hands what one
// returns to the next.
#include "facezip/compress.hpp"

#include <fmt/format.h>
#include <sys/resource.h>

#include <optional>

#include "blocks/block_format.hpp"
#include "compress/attempt.hpp"
#include "compress/border_steps.hpp"
#include "compress/compress_options.hpp"
#include "compress/compress_report.hpp"
#include "compress/compress_stretch.hpp"
#include "compress/face_guides.hpp"
#include "compress/open_textures.hpp"
#include "compress/weight_set_choice.hpp"
#include "io/staged_directory.hpp"
#include "package/footprint.hpp"
#include "rate/rate_search.hpp"

namespace facezip {
namespace {
using namespace compress;
namespace fs = std::filesystem;

std::uint64_t peakMemoryBytes() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;  // Linux counts in KiB
}

std::uint64_t diskBytes(const fs::path& directory) {
  std::uint64_t bytes = 0;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(directory)) {
    if (entry.is_regular_file()) bytes += entry.file_size();
  }
  return bytes;
}

PackageForm formOf(const RatePoint& point) {
  PackageForm form{point.differences, point.weight_scale, point.code_bits, std::nullopt, point.weights_per_map};
  if (point.texture_format) form.blocks = TextureFormats{*point.texture_format, *point.difference_format};
  return form;
}

PackageForm formOf(const CompressOptions& options) {
  const bool stretches = options.method == Method::kCompressStretch;
  PackageForm form{stretches ? kCompressStretchMaps : options.differences, options.weight_scale, std::nullopt,
                   std::nullopt, options.weight_sets == WeightSets::kPerMap};
  if (options.texture_format) {
    form.blocks = TextureFormats{*options.texture_format, options.difference_format.value_or(*options.texture_format)};
  }
  return form;
}

std::optional<RateSearch> searchRates(const CompressOptions& options, const MapSet& maps) {
  if (!options.target_rmse && !options.budget_bytes) return std::nullopt;
  return std::optional<RateSearch>(std::in_place, options, maps);
}

/// Too little memory is to be said before the work, not in its middle, and the refinement's windows need most.
void requireMemory(const CompressOptions& options, const MemoryPlan& memory, const PackageForm& form, MapSet& maps) {
  const auto method = options.method;
  if (method != Method::kRefined && method != Method::kClosedLoop) return;
  for (const std::vector<GridMap>& group : groupMaps(maps, form.weights_per_map, form.weight_scale)) {
    memory.windowRows(form, group);
  }
}

/// A change that the sample of a map's texels missed altogether leaves nothing to estimate by: all of them are shown.
void lookAgain(RateEstimate& estimate, const MapSet& maps, int band_rows, const device::Run& run) {
  BandBuffers buffers(run.context);
  for (std::size_t m = 0; m < maps.maps.size(); ++m) {
    if (!estimate.sawNothing(m)) continue;
    estimate.startOver(m);
    const OpenMap& map = maps.maps[m];
    const auto make_tiles = [&](int begin, int end) { return raster::coverageTiles(*map.raster, begin, end); };
    forEachMapBand(*map.samples, band_rows, buffers, make_tiles, fmt::format("estimating: {}", map.source->name),
                   run.progress, [&](const MapBand& band) { estimate.addBand(m, band); });
  }
}

/// Blocks that do not hold the channels of a map are to be named before the work, too.
void requireFormats(const PackageForm& form, const MapSet& maps) {
  if (!form.blocks) return;
  for (const OpenMap& map : maps.maps) {
    const image::ImageShape& shape = map.samples->shape();
    if (shape.type != SampleType::kUint8) continue;
    for (const BlockFormat format : {form.blocks->neutral, form.blocks->differences}) {
      try {
        blocks::requireChannels(blocks::formatFor(format, shape.channels), shape.channels);
      } catch (const InputError& error) {
        InputError::Parts parts = error.parts();
        parts.item = "map " + map.source->name;
        throw InputError(parts);
      }
    }
  }
}

/// Packages of the forms that a target asks for, one after the other, until one meets it; of the `fixed` form where
/// there is no target.
Attempt makePackages(const CompressionJob& job, const PackageForm& fixed, RateSearch* rates,
                     io::StagedDirectory& staged) {
  if (rates == nullptr) return makePackage(job, fixed, staged.path());
  while (true) {
    const RatePoint point = rates->choose([&job](const RatePoint& p) { return fitsMemory(job, formOf(p)); });
    Attempt attempt = makePackage(job, formOf(point), staged.path());
    const double reached = pooledRmse(job, attempt);
    if (!rates->misses(reached)) return attempt;
    job.run.progress.note(fmt::format("{} reach{} {:.3f}, not {:.3f}: trying more", describe(point),
                                      point.differences == 1 ? "es" : "", reached, *job.options.target_rmse));
    staged.clear();  // the next may have fewer textures
  }
}

}  // namespace

double CompressReport::permutationGap() const {
  if (!permutation_bound || permutation_cost <= 0.0) return 0.0;
  return (permutation_cost - *permutation_bound) / permutation_cost;
}

ProtectedPaths inputsOf(const Capture& capture, const CompressOptions& options) {
  ProtectedPaths inputs = inputsOf(capture);
  if (options.region != "whole") inputs.addFile(options.region, "the region that is read");
  if (options.importance != "none") inputs.addFile(options.importance, "the importance that is read");
  return inputs;
}

CompressReport compressCapture(const Capture& capture, const fs::path& package, const CompressOptions& options,
                               const Device& device, Progress& progress) {
  requireSaneOptions(options);
  inputsOf(capture, options).requireApartFromFolder(package);
  io::StageClock clock;
  const device::Run run{device.context(), progress, clock, options.memory_bytes};
  io::StagedDirectory staged(package, package::footprint(), &progress);
  OpenTextures textures = openTextures(capture, staged.path(), run);
  MapSet& maps = textures.maps;
  const FaceModel model = readFaceModel(capture, options, run);
  const raster::TexelMasks masks(model.face.mesh, model.masks.region, model.masks.masks);
  const GramSlots slots{masks.maskCount(), masks.overlappingPairs()};
  clock.book("masks");

  const auto layOut = [&](std::optional<int> feather) {
    layOutMaps(maps, model.face.mesh, model.face.region, {options.gutter, feather});
  };
  layOut(options.feather.value_or(0));
  std::optional<BorderSteps> border;
  if (!options.feather) border.emplace(maps, model.face.mesh, model.face.region);
  std::optional<RateSearch> rates = searchRates(options, maps);
  std::optional<RateEstimate> sharing = rates ? std::nullopt : estimateWeightSets(options, maps);
  RateEstimate* const estimate = rates ? &rates->estimate() : sharing ? &*sharing : nullptr;
  const PackageForm first_form = rates ? formOf(rates->smallest()) : formOf(options);
  requireFormats(first_form, maps);
  for (const BlockFormat format : options.format_choice) {
    requireFormats(
        {first_form.differences, first_form.weight_scale, std::nullopt, TextureFormats{format, format}, false}, maps);
  }
  const bool each_map = first_form.weights_per_map || (estimate != nullptr && options.weight_sets == WeightSets::kAuto);
  const auto groups = groupMaps(maps, each_map, first_form.weight_scale);
  const MemoryPlan memory(maps, slots, groups.size(), run);
  requireMemory(options, memory, first_form, maps);
  const int band_rows = memory.bandRows(first_form);
  clock.book("weight grid");

  const auto observe = [estimate, &border](std::size_t m, const MapBand& band) {
    if (estimate != nullptr) estimate->addBand(m, band);
    if (border) border->addBand(m, band);
  };
  const GramStage grams = accumulateGrams(groups, masks, slots, model.importance, band_rows, observe, run);
  if (estimate != nullptr) lookAgain(*estimate, maps, band_rows, run);
  if (border && border->largest() >= kVisibleStep) {
    layOut(std::nullopt);
    progress.note(
        fmt::format("at the region's border an expression differs by {:.1f} of 255: differences fade out over {} "
                    "texels beyond it",
                    border->largest(), maps.maps[maps.reference].raster->feather()));
  }

  const CompressionJob job{capture, options, maps, model, masks, grams, memory, run};
  RateSearch* const search = rates ? &*rates : nullptr;
  const PackageForm form = sharing ? chooseWeightSets(*sharing, job, first_form) : first_form;
  const Attempt attempt = makePackages(job, form, search, staged);
  if (options.mesh) {
    writeFaceMesh(capture, model.face, model.masks.unit, model.expression_meshes, staged.path());
    clock.book("mesh");
  }
  CompressReport report = makeReport(job, textures, slots, search, attempt);
  report.border_step = border ? border->largest() : 0.0;
  report.package_disk_bytes = diskBytes(staged.path());
  staged.commit();
  clock.book("publishing");
  report.seconds = clock.seconds();
  report.peak_memory_bytes = peakMemoryBytes();
  return report;
}

}  // namespace facezip
