// method.hpp - how difference textures and weights are found, by value and by name.
#pragma once

#include <vector>

#include "facezip/named_value.hpp"

namespace facezip {

enum class Method {
  kRefined,        ///< from the paper's result, weights and difference textures fitted in turn
  kClosedLoop,     ///< the paper's weights, and per texel the difference textures that suit them best as decoded
  kPaper,          ///< clusters, permuted so that seams fit (FaceZip, section 3.1)
  kNoPermutation,  ///< clusters in the order of the clustering; the paper's ablation, for comparison only
  /// Compress and stretch maps (Li et al. 2020, Eq. 10 to 14), the industry's usual: C is 2, whatever is asked for.
  /// Needs the mesh of every expression.
  kCompressStretch,
};

/// How the permutation is found. Its lower bound is the same for all, and takes the time of kMessagePassing.
enum class PermutationSolver {
  kBest,            ///< the better of the two below
  kDescent,         ///< coordinate descent from random starts (FaceZip, section 3.1)
  kMessagePassing,  ///< message passing between pairs and triangles of masks, greedy starts, branch and bound
};

/// Which maps share a set of weights.
enum class WeightSets {
  kAuto,    ///< a set for each where that errs less than what else its bytes could buy, else one for all
  kShared,  ///< one for all
  kPerMap,  ///< one for each
};

template <>
const std::vector<NamedValue<Method>>& namesOf();
template <>
const std::vector<NamedValue<PermutationSolver>>& namesOf();
template <>
const std::vector<NamedValue<WeightSets>>& namesOf();

}  // namespace facezip
