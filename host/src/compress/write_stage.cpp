#include "compress/write_stage.hpp"

#include <cmath>
#include <memory>

#include "compress/code_bits.hpp"
#include "compress/fit_stage.hpp"
#include "compress/method_record.hpp"
#include "compress/package_output.hpp"
#include "compress/refine/refinement.hpp"

namespace facezip::compress {
namespace {

/// Squared error that 8-bit codes of a map's difference textures would add.
double codeError(const CompressionState& state, const WeightGroup& group, std::size_t m) {
  const std::vector<double> weights = meanSquares(group.weights, state.weightSpace(), state.grid.covered);
  return codeSquaredError(group.ranges[m], weights) * state.coveredTexels(*group.maps[m]) * state.expressions();
}

int bitsOf(const CompressionState& state, const WeightGroup& group, std::size_t m) {
  const SampleType type = group.maps[m]->samples->shape().type;
  // What was chosen was chosen for its size: its bits are kept to.
  if (state.report.rate) return type == SampleType::kUint8 ? 8 : state.report.rate->code_bits;
  if (type == SampleType::kUint8) return 8;  // frames round by more than the codes of their differences do
  return codeBits(codeError(state, group, m), group.errors[m]);
}

/// Where the difference textures of the groups come from.
struct Sources {
  struct Fitted {
    FittedTextures* source;
    OpenMap* map;
    std::size_t group;
  };
  std::vector<std::unique_ptr<TextureSource>> all;
  std::vector<Fitted> fitted;  ///< those of all that know their error
};

bool fitsTextures(CompressOptions::Method method) {
  return method == CompressOptions::Method::kClosedLoop || method == CompressOptions::Method::kRefined;
}

/// Entry `m` of a group as a package holds it; its source is appended to `sources`.
void describeMap(CompressionState& state, std::size_t g, std::size_t m, MapSolution& out, Sources& sources) {
  const WeightGroup& group = state.groups[g];
  OpenMap& map = *group.maps[m];
  const bool fits = fitsTextures(state.options.method);
  out.map = &map;
  out.weight_set = static_cast<int>(g);
  out.bits = fits ? bitsOf(state, group, m) : 8;
  for (const TextureRange& range : group.ranges[m]) out.encoding.push_back(encodingFor(range, out.bits));
  if (fits) {
    const WeightSpace space = state.weightSpace();
    auto source = std::make_unique<FittedTextures>(state.context, space, group.weights,
                                                   ridgeOf(RefinementOptions{}, space), out.encoding, out.bits);
    sources.fitted.push_back({source.get(), &map, g});
    sources.all.push_back(std::move(source));
  } else {
    sources.all.push_back(directTextures(state, group));
  }
  out.source = sources.all.back().get();
}

/// Squared errors of the groups; those of their maps go into the report.
std::vector<double> reportErrors(CompressionState& state, const Sources& sources) {
  std::vector<double> errors(state.groups.size(), 0.0);
  state.report.rmse.clear();
  for (const auto& [source, map, group] : sources.fitted) {
    errors[group] += map->fit_weight * source->squaredError();
    const double samples = state.coveredTexels(*map) * map->samples->shape().channels * state.expressions();
    state.report.rmse.emplace_back(map->source->name, std::sqrt(source->squaredError() / samples));
  }
  return errors;
}

}  // namespace

std::vector<double> writeGroups(CompressionState& state) {
  PackageSolution solution;
  solution.differences = state.options.differences;
  solution.method_json = methodJson(state.options, state.report, state.face.region_description);
  solution.has_mesh = state.options.mesh;
  solution.guides = state.guides;
  solution.maps.resize(state.maps.maps.size());  // in the capture's order; sources keep references to the encodings
  Sources sources;
  for (std::size_t g = 0; g < state.groups.size(); ++g) {
    const WeightGroup& group = state.groups[g];
    solution.weights.push_back(group.weights);
    for (std::size_t m = 0; m < group.maps.size(); ++m) {
      const auto index = static_cast<std::size_t>(group.maps[m] - state.maps.maps.data());
      describeMap(state, g, m, solution.maps[index], sources);
    }
  }
  const auto pass = [&state](OpenMap& map, TextureSource& source, const std::function<void(const MapBand&)>& visit) {
    state.forEachBand(map, "writing", source, visit);
  };
  state.staged.clear();  // an attempt before may have had more textures
  writePackage(state.context, state.capture, solution, pass, state.staged.path());
  state.clock.book("writing");
  return reportErrors(state, sources);
}

}  // namespace facezip::compress
