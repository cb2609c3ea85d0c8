// candidates.hpp - the packages that an evaluation decodes side by side.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "evaluate/baseline_packages.hpp"
#include "evaluate/package_decoder.hpp"
#include "evaluate/subject.hpp"
#include "facezip/evaluate.hpp"
#include "io/stage_clock.hpp"

namespace facezip::evaluate {

/// A package beside its key in the results.
struct Candidate {
  std::string key;
  std::unique_ptr<TemporaryPackage> temporary;  ///< none for the package that is evaluated
  std::unique_ptr<PackageDecoder> decoder;
};

struct Candidates {
  std::vector<Candidate> all;               ///< the package itself first
  std::vector<std::string> own_keys;        ///< under which the package is known too: its method's first
  std::optional<PermutationSearch> search;  ///< of the first package whose clusters were permuted
};

/// Compresses what the options ask for beside the package, one after the other. package  outlives the result
/// Throws what compressCapture() throws.
Candidates makeCandidates(const Package& package, const Subject& subject, const EvaluateOptions& options,
                          io::StageClock& clock);

}  // namespace facezip::evaluate
