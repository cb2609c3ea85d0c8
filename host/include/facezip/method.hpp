// method.hpp - how difference textures and weights are found, by value and by name.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

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

/// A value of an enumeration as the command line, package.json and reports spell it, and what tables call it.
template <typename Value>
struct NamedValue {
  Value value;
  std::string_view name;   ///< "no-permutation"
  std::string_view title;  ///< "not permuted"
};

/// All values of an enumeration, in the order that tables have them. Defined for Method, PermutationSolver and
/// Baseline.
template <typename Value>
const std::vector<NamedValue<Value>>& namesOf();
template <>
const std::vector<NamedValue<Method>>& namesOf();
template <>
const std::vector<NamedValue<PermutationSolver>>& namesOf();

template <typename Value>
std::string nameOf(Value value) {
  for (const NamedValue<Value>& entry : namesOf<Value>()) {
    if (entry.value == value) return std::string(entry.name);
  }
  return "";  // not reached: every value is in its table
}

/// The value of that name; none where no value has it.
template <typename Value>
std::optional<Value> findNamed(std::string_view name) {
  for (const NamedValue<Value>& entry : namesOf<Value>()) {
    if (entry.name == name) return entry.value;
  }
  return std::nullopt;
}

/// The names, for choices on a command line.
template <typename Value>
std::vector<std::string> allNames() {
  std::vector<std::string> names;
  for (const NamedValue<Value>& entry : namesOf<Value>()) names.emplace_back(entry.name);
  return names;
}

}  // namespace facezip
