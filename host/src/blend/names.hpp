// names.hpp - expressions by name.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "facezip/package.hpp"

namespace facezip::blend {

/// Least number of insertions, deletions, substitutions and swaps of neighbours that turn `a` into `b`, upper and lower
/// case alike.
int editDistance(std::string_view a, std::string_view b);

/// The up to `most` names nearest to `name`, nearest first; names of equal distance in their given order.
std::vector<std::string> nearestNames(const std::string& name, const std::vector<std::string>& names,
                                      std::size_t most = 3);

/// Throws InputError (item `item`) that lists the nearest names there are.
[[noreturn]] void refuseUnknown(const Package& package, const std::string& name, const std::string& item);

/// Index of the expression `name`, or of the one that shows the same shape. Throws InputError as refuseUnknown().
int expressionIndex(const Package& package, const std::string& name, const std::string& item);

}  // namespace facezip::blend
