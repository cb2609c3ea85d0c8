// names.hpp - expressions by name.
#pragma once

#include <string>

#include "facezip/package.hpp"

namespace facezip::blend {

/// Throws InputError (item `item`) that lists the nearest names there are.
[[noreturn]] void refuseUnknown(const Package& package, const std::string& name, const std::string& item);

/// Index of the expression `name`, or of the one that shows the same shape. Throws InputError as refuseUnknown().
int expressionIndex(const Package& package, const std::string& name, const std::string& item);

}  // namespace facezip::blend
