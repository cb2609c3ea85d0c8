// package_json.hpp - package.json as text (docs/package_format.md).
#pragma once

#include <string>

#include "facezip/package.hpp"

namespace facezip::package {

inline constexpr char kDescriptionFile[] = "package.json";
inline constexpr int kFormatVersion = 3;       ///< newest, of packages with textures in blocks
inline constexpr int kImageFormatVersion = 2;  ///< of all others: older facezips read them
inline constexpr int kMaxDifferences = 8;      ///< C
inline constexpr int kMaxSide = 65536;         ///< texels along a side of a map
inline constexpr int kMaxAtlasSide = 16384;    ///< what every GPU of the last decade takes as a texture

/// The text of package.json for `description`. Throws InputError for names that are not UTF-8 or a method_json that is
/// not JSON; everything else is parsePackageJson's to refuse.
std::string packageJson(const PackageDescription& description);

/// Reads and checks every field; `text` is untrusted. Does not look at images.
/// file  path for messages
/// Throws InputError that names `file`, the field as a JSON path, what was expected and what was found.
PackageDescription parsePackageJson(const std::string& text, const std::string& file);

}  // namespace facezip::package
