// texture_copy.hpp - images of a package as plain textures of 8 bits, some rows at a time: they may be of any size.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "facezip/package.hpp"
#include "facezip/progress.hpp"
#include "image/image_file.hpp"

namespace facezip::exporting {

/// An image of the package: its file and what package.json says of it.
struct PackageImage {
  std::string file;
  image::ImageShape shape;
};

/// Writes an image of integers as PNG: codes of 16 bits as the nearest of 8, rows from the top, nothing recorded that a
/// reader might convert by. Throws InputError, OutputError, Cancelled.
void copyTexture(const Package& package, const PackageImage& image, const std::filesystem::path& to,
                 Progress& progress);

/// Writes several of one shape side by side, `columns` in a row, as one. Where the last row is not full, zeros.
void copyTextures(const Package& package, const std::vector<PackageImage>& images, int columns,
                  const std::filesystem::path& to, Progress& progress);

}  // namespace facezip::exporting
