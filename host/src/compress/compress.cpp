// compress.cpp - the FaceZip method from end to end. Each stage is a step of its own file; this one puts them in order.
#include "facezip/compress.hpp"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <map>
#include <thread>

#include "compress/compress_options.hpp"
#include "compress/compression_state.hpp"
#include "compress/fit_stage.hpp"
#include "compress/gram_stage.hpp"
#include "compress/open_stage.hpp"
#include "compress/rate_stage.hpp"
#include "compress/refine/refinement.hpp"
#include "compress/search_stage.hpp"
#include "compress/write_stage.hpp"

namespace facezip {
namespace {
using namespace compress;
namespace fs = std::filesystem;

using Method = CompressOptions::Method;

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

/// The weight grid: masks at its cells.
void layGrid(CompressionState& state) {
  if (state.rates) chooseRate(state);
  state.progress.stage("weight grid", 0);
  state.grid = raster::makeGridMasks(*state.texel_masks, *state.maps.maps[state.maps.reference].raster,
                                     state.options.weight_scale);
  state.guides = makeMaskGuides(state.face, state.masks, state.grid);  // while the grid has its masks
  state.clock.book("weight grid");
  if (state.expressions() <= state.options.differences) {
    state.progress.note(fmt::format("{} expression{}: each gets a difference texture of its own", state.expressions(),
                                    state.expressions() == 1 ? "" : "s"));
  }
}

/// Writes refined weights, but where rounding made those of a group worse than the paper's with textures that suit
/// them it keeps the paper's: that can only be where they are exact or nearly so.
void refineAndWrite(CompressionState& state) {
  // As many textures as expressions: the start is exact already.
  const int sweeps = state.expressions() <= state.options.differences ? 0 : RefinementOptions{}.most_sweeps;
  state.report.refinement_errors.clear();
  for (WeightGroup& group : state.groups) fitWeights(state, group, sweeps);
  const std::vector<double> refined_errors = writeGroups(state);
  constexpr double kSuspicious = 0.5;          // of the start's error; refinement commonly leaves a third
  std::map<std::size_t, WeightGroup> refined;  // that may be worse than the start
  for (std::size_t g = 0; sweeps > 0 && g < state.groups.size(); ++g) {
    if (refined_errors[g] > kSuspicious * state.groups[g].start_error) refined[g] = state.groups[g];
  }
  if (refined.empty()) return;
  for (const auto& [g, group] : refined) fitWeights(state, state.groups[g], 0);
  const std::vector<double> start_errors = writeGroups(state);
  std::erase_if(refined, [&](const auto& entry) { return start_errors[entry.first] <= refined_errors[entry.first]; });
  for (auto& [g, group] : refined) state.groups[g] = std::move(group);
  if (refined.empty()) {
    state.progress.note("the paper's weights are exact here: they are kept");
  } else {
    writeGroups(state);
  }
}

void solveAndWrite(CompressionState& state) {
  switch (state.options.method) {
    case Method::kPaper:
    case Method::kNoPermutation:
    case Method::kCompressStretch:
      for (WeightGroup& group : state.groups) keepWeights(state, group);
      writeGroups(state);
      return;
    case Method::kClosedLoop:
      for (WeightGroup& group : state.groups) fitWeights(state, group, 0);
      writeGroups(state);
      return;
    case Method::kRefined:
      refineAndWrite(state);
      return;
  }
}

/// What is left when the textures are written: the mesh, the package's place, the report.
void publish(CompressionState& state) {
  state.report.differences = state.options.differences;
  state.report.weight_scale = state.options.weight_scale;
  if (state.options.mesh) {
    writeFaceMesh(state.capture, state.face, state.masks.unit, state.expression_meshes, state.staged.path());
    state.clock.book("mesh");
  }
  state.report.package_disk_bytes = diskBytes(state.staged.path());
  state.staged.commit();
  state.clock.book("publishing");
  for (const OpenMap& map : state.maps.maps) {
    state.report.wait_seconds += map.samples->waitSeconds();
    state.report.decode_seconds += map.samples->decodeSeconds();
  }
  state.report.seconds = state.clock.seconds();
  state.report.peak_memory_bytes = peakMemoryBytes();
}

}  // namespace

double CompressReport::permutationGap() const {
  if (!permutation_bound || permutation_cost <= 0.0) return 0.0;
  return (permutation_cost - *permutation_bound) / permutation_cost;
}

CompressReport compressCapture(const Capture& capture, const fs::path& package, const CompressOptions& options,
                               const Device& device, Progress& progress) {
  requireSaneOptions(options);
  CompressionState state(capture, package, options, device.context(), progress);
  state.report.device = device.info().name;
  const std::jthread decoder = openTextures(state);  // reads the state: the first to go
  readGeometry(state);
  planBands(state);
  accumulateGrams(state);
  do {
    layGrid(state);
    for (WeightGroup& group : state.groups) searchWeights(state, group);
    state.grid.cells = {};  // weights took their place
    solveAndWrite(state);
  } while (missesTarget(state));
  publish(state);
  return state.report;
}

}  // namespace facezip
