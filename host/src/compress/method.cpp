#include "facezip/method.hpp"

namespace facezip {

template <>
const std::vector<NamedValue<Method>>& namesOf() {
  static const std::vector<NamedValue<Method>> names = {
      {Method::kCompressStretch, "compress-stretch", "compress/stretch"},
      {Method::kRefined, "refined", "refined"},
      {Method::kClosedLoop, "closed-loop", "closed loop"},
      {Method::kPaper, "paper", "paper"},
      {Method::kNoPermutation, "no-permutation", "not permuted"},
  };
  return names;
}

template <>
const std::vector<NamedValue<PermutationSolver>>& namesOf() {
  static const std::vector<NamedValue<PermutationSolver>> names = {
      {PermutationSolver::kBest, "best", "best"},
      {PermutationSolver::kDescent, "descent", "coordinate descent"},
      {PermutationSolver::kMessagePassing, "message-passing", "message passing"},
  };
  return names;
}

template <>
const std::vector<NamedValue<WeightSets>>& namesOf() {
  static const std::vector<NamedValue<WeightSets>> names = {
      {WeightSets::kAuto, "auto", "chosen"},
      {WeightSets::kShared, "shared", "one set"},
      {WeightSets::kPerMap, "per-map", "a set for every map"},
  };
  return names;
}

}  // namespace facezip
