// safe_names.hpp - names of an untrusted package.json that become paths.
#pragma once

#include <string>

#include "package/json_field.hpp"

namespace facezip::package {

/// A name that becomes a file or folder name when textures are written: it must not leave the folder, nor hide in it.
/// Throws InputError.
std::string fileSafeName(const JsonField& field);

/// The path of a file inside the package that ends in `extension`. Throws InputError.
std::string fileInPackage(const JsonField& field, const std::string& extension);

}  // namespace facezip::package
