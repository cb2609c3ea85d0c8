// safe_names.hpp - names of an untrusted package.json that become paths, and of what packages are made of.
#pragma once

#include <optional>
#include <string>

#include "io/json_field.hpp"

namespace facezip::io {

/// For messages: what a name must be, and what it is.
struct NameFault {
  std::string expected;
  std::string got;
};

/// What is wrong with a name that becomes a file or folder name when textures are written: it must not leave the
/// folder, nor hide in it, and JSON must hold it; `further` are characters that it must not have besides. Nothing where
/// it may be used.
std::optional<NameFault> nameFault(const std::string& name, const std::string& further = "");

bool isUtf8(const std::string& text);

/// A name without such a fault, composed (io/composed.hpp). Throws InputError.
std::string fileSafeName(const JsonField& field);

/// The path of a file inside the package that ends in `extension`. Throws InputError.
std::string fileInPackage(const JsonField& field, const std::string& extension);

}  // namespace facezip::io
