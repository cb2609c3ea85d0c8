// nearest_names.hpp - what a misspelt name may mean.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace facezip {

/// Least number of insertions, deletions, substitutions and swaps of neighbours that turn `a` into `b`, upper and lower
/// case alike.
int editDistance(std::string_view a, std::string_view b);

/// The up to `most` names nearest to `name`, nearest first; names of equal distance in their given order.
std::vector<std::string> nearestNames(const std::string& name, const std::vector<std::string>& names,
                                      std::size_t most = 3);

}  // namespace facezip
