#include "evaluate/candidates.hpp"

#include <utility>

namespace facezip::evaluate {
namespace {

Candidate decoded(const std::string& key, const Package& package, const Subject& subject,
                  std::vector<std::vector<float>> expressions) {
  auto decoder = std::make_unique<PackageDecoder>(package, subject.device);
  decoder->setExpressions(std::move(expressions));
  return {key, nullptr, std::move(decoder)};
}

Candidate compressed(const std::string& key, const CompressOptions& options, const Subject& subject) {
  auto temporary = std::make_unique<TemporaryPackage>(subject.capture, options, key, subject.device, subject.progress);
  auto decoder = std::make_unique<PackageDecoder>(temporary->package(), subject.device);
  return {key, std::move(temporary), std::move(decoder)};
}

}  // namespace

Candidates makeCandidates(const Package& package, const Subject& subject, const EvaluateOptions& options,
                          io::StageClock& clock) {
  Candidates candidates;
  candidates.own_keys = {nameOf(subject.recorded.method)};
  candidates.all.push_back(decoded("package", package, subject, subject.as_packed));
  if (!subject.as_rigged.empty()) candidates.all.push_back(decoded("rig", package, subject, subject.as_rigged));
  const auto add = [&](const std::string& key, const CompressOptions& compress) {
    candidates.all.push_back(compressed(key, compress, subject));
    const CompressReport& report = candidates.all.back().temporary->report();
    if (!report.convergence.empty() && !candidates.search) {
      candidates.search = PermutationSearch{report.permutation_cost, report.permutation_bound, report.convergence};
    }
    clock.book("compressing: " + key);
  };
  for (const auto& entry : namesOf<Method>()) {
    if (!options.methods.contains(entry.value) || entry.value == subject.recorded.method) continue;
    CompressOptions compress = subject.recorded;
    compress.method = entry.value;
    add(std::string(entry.name), compress);
  }
  if (options.baselines.contains(Baseline::kWeightsPerMap)) {
    const std::string key = nameOf(Baseline::kWeightsPerMap);
    if (package.maps().size() == package.weightSets().size()) {
      candidates.own_keys.push_back(key);
    } else {
      CompressOptions compress = subject.recorded;
      compress.weight_sets = WeightSets::kPerMap;
      add(key, compress);
    }
  }
  return candidates;
}

}  // namespace facezip::evaluate
