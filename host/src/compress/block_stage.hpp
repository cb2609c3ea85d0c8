// block_stage.hpp - what block-compressed textures add to pass 2: neutrals are coded first, and weights are fitted to
// what the blocks of the difference textures decode to.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "codes/coded_refinement.hpp"
#include "compress/fit_stage.hpp"
#include "compress/package_form.hpp"
#include "compress/write_stage.hpp"

namespace facezip::compress {

/// Of every map of a group: its neutral in blocks of the form's; none for maps that are kept as images, because blocks
/// would round away what they have more than 8 bits for.
std::vector<std::optional<CodedNeutral>> codeNeutrals(const PackageForm& form, std::span<const GridMap> group,
                                                      const device::Run& run);

/// Weights that suit what the blocks decode to. fitted  with its neutrals
EncodedWeights fitWeightsToBlocks(const FitProblem& problem, const PackageForm& form, const FittedWeights& fitted,
                                  const CoveredFace& face, const device::Run& run);

/// The same of maps whose codes are known.
/// weights  that are fitted to textures that are not coded
EncodedWeights refitWeights(const FitProblem& problem, const EncodedWeights& weights, std::span<const CodedMap> maps,
                            const device::Run& run);

}  // namespace facezip::compress
