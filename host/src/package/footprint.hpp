// footprint.hpp - the files of a package, and which directories are packages that may be replaced.
#pragma once

#include <string>
#include <vector>

#include "facezip/package.hpp"
#include "io/staged_directory.hpp"

namespace facezip::package {

/// Names of the files of a package, relative to it, package.json first; maps may share files, which count once.
std::vector<std::string> filesOf(const PackageDescription& description);

/// Of packages: the files that package.json names, and what `facezip rig` adds.
io::Footprint footprint();

}  // namespace facezip::package
