// file_copy.hpp - a file of a package, byte for byte.
#pragma once

#include <filesystem>
#include <string>

#include "facezip/package.hpp"

namespace facezip::package {

/// Copies file `name` of the package. Throws InputError, OutputError.
void copyFile(const Package& package, const std::string& name, const std::filesystem::path& to);

}  // namespace facezip::package
