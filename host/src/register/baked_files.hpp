// baked_files.hpp - baked textures, made whole and put down in a capture.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "register/texture_baking.hpp"

namespace facezip::registration {

/// FOLDER/NAME.png, or .exr for floats. Throws OutputError.
void writeTexture(const std::filesystem::path& folder, const std::string& name, const BakedTexture& texture);

/// Its confidence, as FOLDER/NAME.png. Throws OutputError.
void writeConfidence(const std::filesystem::path& folder, const std::string& name, const BakedTexture& texture);

/// The neutral's texture is whole once its holes are filled from around them; an expression's follow the neutral's.
/// neutral  null for itself
void fillTexture(BakedTexture& texture, const BakedTexture* neutral);

/// Throws InputError where a scan's textures are of other channels or another type than the neutral's.
void requireSameChannels(const BakedTexture& texture, const BakedTexture& neutral, const std::filesystem::path& file);

/// Share of the region's texels that the scan shows. region  [side][side]
double coverageOf(const BakedTexture& texture, const std::vector<bool>& region);

}  // namespace facezip::registration
