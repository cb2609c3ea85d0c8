// evaluate.cpp - an evaluation from end to end: packages beside the one in question, then every map, then the studies.
#include "facezip/evaluate.hpp"

#include <algorithm>

#include "evaluate/ablation.hpp"
#include "evaluate/blend_error.hpp"
#include "evaluate/candidates.hpp"
#include "evaluate/every_texture.hpp"
#include "evaluate/map_evaluation.hpp"
#include "evaluate/subject.hpp"
#include "io/stage_clock.hpp"

namespace facezip {
namespace {
using namespace compress;
using namespace evaluate;

/// Bytes at run time, of textures as the paper's Table 1 counts them.
void countBytes(const Package& package, const Candidates& candidates, const Subject& subject,
                const EvaluateOptions& options, Evaluation& evaluation) {
  std::uint64_t textures = 0;  // one of every map
  for (const PackageMap& map : package.maps()) textures += map.frameBytes();
  evaluation.bytes["neutral"] = textures;
  evaluation.bytes["raw"] = textures * (static_cast<std::uint64_t>(subject.expressions()) + 1);
  // There are no more components than expressions.
  const auto pca = [&](int components) {
    return textures * (static_cast<std::uint64_t>(std::min(components, subject.expressions())) + 1);
  };
  if (options.baselines.contains(Baseline::kPca4)) evaluation.bytes[nameOf(Baseline::kPca4)] = pca(4);
  if (options.baselines.contains(Baseline::kPca8)) evaluation.bytes[nameOf(Baseline::kPca8)] = pca(8);
  for (const Candidate& candidate : candidates.all) {
    evaluation.bytes[candidate.key] = candidate.decoder->package().bytesInMemory();
  }
  for (const std::string& key : candidates.own_keys) evaluation.bytes[key] = package.bytesInMemory();
  for (const BlockFormat format : options.every_texture) {
    std::uint64_t& bytes = evaluation.bytes[everyTextureKey(format)];
    for (const PackageMap& map : package.maps()) bytes += everyTextureBytes(map, format, subject.expressions());
  }
  evaluation.bytes["package_disk"] = package.bytesOnDisk();
  if (!options.ablation) return;
  for (const int components : {1, 2, 3, 4, 8}) evaluation.ablation_bytes["pca"][components] = pca(components);
}

/// Every map of the package beside the candidates, which are gone when this returns.
void evaluateMaps(const Package& package, const Subject& subject, const EvaluateOptions& options, io::StageClock& clock,
                  Evaluation& evaluation) {
  Candidates candidates = makeCandidates(package, subject, options, clock);
  evaluation.search = candidates.search;
  BandBuffers buffers(subject.device.context());
  const MapSet maps = openMaps(subject);
  for (std::size_t m = 0; m < maps.maps.size(); ++m) {
    MapEvaluation found =
        evaluateMap(maps.maps[m], static_cast<int>(m), candidates, subject, options, evaluation.blend_weights, buffers);
    if (m == 0) evaluation.covered_texels = found.covered_texels;
    for (const BlockFormat format : options.every_texture) {
      if (auto errors = everyTextureErrors(maps.maps[m], format, subject)) {
        found.map.rmse[everyTextureKey(format)] = std::move(*errors);
      }
    }
    evaluation.maps.push_back(std::move(found.map));
    if (found.pictures) evaluation.pictures.push_back(std::move(*found.pictures));
  }
  countBytes(package, candidates, subject, options, evaluation);
  clock.book("comparing");
}

}  // namespace

Evaluation evaluatePackage(const Capture& capture, const Package& package, const EvaluateOptions& options,
                           const Device& device, Progress& progress) {
  if (options.pictures && !options.pictures->map.empty()) package.mapIndex(options.pictures->map);  // or throws
  io::StageClock clock;
  const Subject subject = makeSubject(capture, package, options.memory_bytes, options.shapes, device, progress);
  Evaluation evaluation;
  evaluation.method = nameOf(subject.recorded.method);
  evaluation.differences = package.differences();
  evaluation.expressions = subject.capture.expressions;
  evaluation.blend_weights = randomWeightVectors(subject.recorded.seed, options.blends, subject.expressions());
  evaluateMaps(package, subject, options, clock, evaluation);
  if (options.ablation) {
    addAblation(subject, evaluation);
    clock.book("ablation");
  }
  if (!options.mask_sweep.empty()) {
    addMaskSweep(subject, options.mask_sweep, evaluation);
    clock.book("mask sweep");
  }
  evaluation.seconds = clock.seconds();
  return evaluation;
}

}  // namespace facezip
