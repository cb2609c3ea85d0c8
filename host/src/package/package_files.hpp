// package_files.hpp - the images of a package: their names, their shapes, and whether they are what package.json says.
#pragma once

#include <cstdint>
#include <string>

#include "facezip/package.hpp"
#include "image/image_file.hpp"
#include "io/folder.hpp"

namespace facezip::package {

/// Of a map's frames, and of a neutral that is stored as an image.
image::ImageShape neutralShape(const PackageMap& map);
/// Of difference textures that are stored as images.
image::ImageShape differenceShape(const PackageMap& map);

/// Opens an image of the package. Throws InputError that names the file when it is missing, unreadable or not of
/// `shape`.
image::ImageReader openImage(const io::Folder& folder, const std::string& file, const image::ImageShape& shape);

/// Opens an image of the package and checks that it is not cut short. Returns its bytes. Throws InputError.
std::uint64_t checkImage(const io::Folder& folder, const std::string& file, const image::ImageShape& shape);

/// Opens every texture of `description` and checks its shape and that it is not cut short.
/// Returns the bytes of all of them. Throws InputError that names the file.
std::uint64_t checkTextures(const PackageDescription& description, const io::Folder& folder);

}  // namespace facezip::package
