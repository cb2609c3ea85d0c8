#include "compress/open_stage.hpp"

#include <fmt/format.h>

#include <stop_token>

#include "compress/rate_stage.hpp"
#include "image/scratch_file.hpp"

namespace facezip::compress {
namespace {

/// Textures are decoded once, into a scratch file beside the package, where the disk has room for it: true then.
bool keepDecoded(CompressionState& state) {
  std::uint64_t decoded_bytes = 0;
  for (const OpenMap& map : state.maps.maps) decoded_bytes += map.samples->decodedBytes();
  const std::filesystem::path directory = state.staged.path();
  // Room for the package itself is kept free: it is never larger than the decoded textures.
  if (image::ScratchFile::freeBytes(directory) < 2 * decoded_bytes) {
    state.report.decoded = "decoded again";
    state.progress.note(
        fmt::format("no room for {} MB of decoded textures beside the package: decoding them in every pass",
                    decoded_bytes / 1000000));
    return false;
  }
  state.report.decoded = "scratch file";
  for (OpenMap& map : state.maps.maps) map.samples->keepDecoded(directory);
  return true;
}

}  // namespace

std::jthread openTextures(CompressionState& state) {
  state.maps = openMaps(state.capture);
  if (!keepDecoded(state)) return {};
  return std::jthread([&state](const std::stop_token& stop) {
    for (OpenMap& map : state.maps.maps) map.samples->decode(stop);
  });
}

void readGeometry(CompressionState& state) {
  state.progress.stage("reading meshes", 0);
  state.face = readFace(state.capture, state.options.region);
  state.expression_meshes = readExpressionMeshes(state.capture, state.face.mesh, state.progress);
  if (!state.options.mesh) state.expression_meshes.clear();
  const std::filesystem::path painted = state.options.importance.empty()
                                            ? state.capture.importance.value_or("")
                                            : std::filesystem::path(state.options.importance);
  if (!painted.empty() && painted != "none") state.importance.emplace(painted);
  state.clock.book("meshes");
  state.masks = makeFaceMasks(state.capture, state.face, state.options, state.progress);
  state.report.masks = state.masks.masks.mask_count;
  constexpr int kManyMasks = 500;  // a face has some 60
  if (state.report.masks > kManyMasks) {
    state.progress.note(
        fmt::format("{} masks: the permutation search grows with their square; a larger --mask-radius "
                    "gives fewer",
                    state.report.masks));
  }
  state.report.mask_radius = state.masks.samples.radius;
  state.report.unit = state.masks.unit ? geometry::unitSymbol(*state.masks.unit) : "";
  state.report.unit_guessed = state.masks.unit_guessed;
  state.report.cut_mass_mean = state.masks.masks.cost.mean_removed;
  state.report.cut_mass_max = state.masks.masks.cost.largest_removed;
  state.report.active_masks_mean = state.masks.masks.cost.mean_active_after;
  state.texel_masks = std::make_unique<raster::TexelMasks>(state.face.mesh, state.masks.region, state.masks.masks);
  state.gram_slots = {state.report.masks, state.texel_masks->overlappingPairs()};
  state.clock.book("masks");
}

void planBands(CompressionState& state) {
  makeRasters(state.maps, state.face.mesh, state.face.region, state.options.gutter);
  classifyTexels(state.maps);
  state.groups.resize(state.options.weights_per_map ? state.maps.maps.size() : 1);
  for (std::size_t m = 0; m < state.maps.maps.size(); ++m) {
    state.groups[state.options.weights_per_map ? m : 0].maps.push_back(&state.maps.maps[m]);
  }
  for (const WeightGroup& group : state.groups) assignFitWeights(group.maps);
  if (state.options.target_rmse || state.options.budget_bytes) {
    state.rates = std::make_unique<RateSearch>(state.options, state.maps, state.expressions(), state.weightSets());
    takeRate(state, state.rates->smallest());
  } else {
    assignWeightScales(state.maps, state.options.weight_scale);
  }
  // Too little memory is to be said before the work, not in its middle, and the refinement's windows need most.
  const auto method = state.options.method;
  if (method == CompressOptions::Method::kRefined || method == CompressOptions::Method::kClosedLoop) {
    for (const WeightGroup& group : state.groups) state.plannedWindowRows(group);
  }
  state.report.band_rows = state.plannedBandRows();
  state.clock.book("weight grid");
}

}  // namespace facezip::compress
