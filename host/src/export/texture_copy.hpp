// texture_copy.hpp - textures of a package as plain ones of 8 bits, some rows at a time: they may be of any size.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "facezip/package.hpp"
#include "facezip/progress.hpp"
#include "package/package_textures.hpp"

namespace facezip::exporting {

/// Writes a texture of integers as PNG, blocks as what they decode to: codes of 16 bits as the nearest of 8, rows from
/// the top, nothing recorded that a reader might convert by. Throws InputError, OutputError, Cancelled.
void copyTexture(const Package& package, const package::StoredTexture& texture, const std::filesystem::path& to,
                 Progress& progress);

/// Writes several of one shape side by side, `columns` in a row, as one. Where the last row is not full, zeros.
void copyTextures(const Package& package, const std::vector<package::StoredTexture>& textures, int columns,
                  const std::filesystem::path& to, Progress& progress);

}  // namespace facezip::exporting
