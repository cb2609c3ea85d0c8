// check.hpp - whether every texel of a package can be read.
#pragma once

#include <cstdint>

#include "facezip/memory.hpp"
#include "facezip/package.hpp"
#include "facezip/progress.hpp"

namespace facezip {

/// Checks the mesh of `package` as docs/package_format.md has it, if it has one. Throws as checkTexels() does.
void checkMesh(const Package& package, std::uint64_t memory_bytes = kDefaultMemoryBytes);

/// Reads all images of `package` from end to end, and its mesh, which Package::open() does not.
/// memory_bytes  what that may take, about
/// Throws InputError that names the file that is damaged, or needs more memory; Cancelled.
void checkTexels(const Package& package, Progress& progress, std::uint64_t memory_bytes = kDefaultMemoryBytes);

}  // namespace facezip
