// check.hpp - whether every texel of a package can be read.
#pragma once

#include "facezip/package.hpp"
#include "facezip/progress.hpp"

namespace facezip {

/// Reads all images of `package` from end to end, which Package::open() does not. Throws InputError that names the file
/// that is damaged, Cancelled.
void checkTexels(const Package& package, Progress& progress);

}  // namespace facezip
