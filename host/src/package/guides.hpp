// guides.hpp - what a package may hold beside what frames need: mesh, parts, masks and named regions
// (docs/package_format.md).
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>

#include "facezip/package.hpp"
#include "image/image_file.hpp"
#include "io/folder.hpp"
#include "io/json_field.hpp"

namespace facezip::package {

inline constexpr char kMeshFile[] = "mesh.glb";
inline constexpr char kPartsFile[] = "parts.glb";
inline constexpr std::size_t kMostParts = 256;
inline constexpr char kMasksFile[] = "masks.png";
inline constexpr int kMostMaskCells = 128;  ///< along a side: masks are smooth

/// Puts the fields `mesh`, `parts`, `masks` and `regions` of what `description` has into `document`.
void addGuides(const PackageDescription& description, nlohmann::ordered_json& document);

/// Reads them, where they are. Throws InputError.
void parseGuides(const io::JsonField& document, PackageDescription& description);

/// Size of the image of the masks.
image::ImageShape masksShape(const PackageMasks& masks);

/// The texture of a material that has one.
image::ImageShape textureShape(const PackageMaterial& material);

/// A material as package.json has it, and back. Throws InputError.
nlohmann::ordered_json materialJson(const PackageMaterial& material);
PackageMaterial parseMaterial(const io::JsonField& field);

/// Checks that mesh, parts and masks are there and not cut short. Returns their bytes. Throws InputError that names the
/// file.
std::uint64_t checkGuides(const PackageDescription& description, const io::Folder& folder);

}  // namespace facezip::package
