#include "compress/block_stage.hpp"

#include <fmt/format.h>

#include "blocks/block_format.hpp"

namespace facezip::compress {
namespace {

/// Turns of textures and weights. Most is gained by the first two; beyond the third little is left.
constexpr int kTurns = 3;

}  // namespace

std::vector<std::optional<CodedNeutral>> codeNeutrals(const PackageForm& form, std::span<const GridMap> group,
                                                      const device::Run& run) {
  std::vector<std::optional<CodedNeutral>> neutrals;
  for (const GridMap& map : group) {
    std::optional<CodedNeutral>& neutral = neutrals.emplace_back();
    const image::ImageShape& shape = map.map->samples->shape();
    if (!inBlocks(form, map)) {
      run.progress.note(fmt::format("map {} has {} samples, more than blocks hold: it is kept as images",
                                    map.map->source->name, image::sampleTypeName(shape.type)));
      continue;
    }
    neutral = codeNeutral(run.context, *map.map, blocks::formatFor(form.blocks->neutral, shape.channels),
                          blocks::Quality::kNormal, run.progress);
  }
  run.clock.book("coding neutrals");
  return neutrals;
}

EncodedWeights fitWeightsToBlocks(const FitProblem& problem, const PackageForm& form, const FittedWeights& fitted,
                                  const CoveredFace& face, const device::Run& run) {
  const std::vector<MapCodes> codes = codesOf(form, problem.space, problem.maps, fitted, face);
  std::vector<CodedMap> maps;
  for (std::size_t m = 0; m < problem.maps.size(); ++m) {
    const auto& neutral = fitted.neutrals[m];
    maps.push_back({problem.maps[m],
                    {codes[m].formats, codes[m].encoding, problem.maps[m].map->samples->shape().channels},
                    neutral ? &*neutral : nullptr});
  }
  return refitWeights(problem, fitted.weights, maps, run);
}

EncodedWeights refitWeights(const FitProblem& problem, const EncodedWeights& weights, std::span<const CodedMap> maps,
                            const device::Run& run) {
  const CodedProblem coded{problem.space,      weights, maps, weighedTiles(problem), cellEnergy(problem),
                           problem.window_rows};
  const GridWeights refined = refineCoded(run.context, coded, RefinementOptions{}, kTurns, run.progress);
  run.clock.book("fitting to blocks");
  return encodeFitted(refined, problem);
}

}  // namespace facezip::compress
