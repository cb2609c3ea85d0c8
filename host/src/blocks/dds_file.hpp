// dds_file.hpp - DDS (Microsoft) with its DX10 header, for 2D textures of BC blocks: what Direct3D tools read. Levels
// follow the header at once, the largest first.
#pragma once

#include <filesystem>

#include "blocks/file_header.hpp"

namespace facezip::blocks {

/// Direct3D's own limit; with it the bytes of a level, which the header has, fit its 32 bits.
inline constexpr int kLargestDdsSide = 16384;

/// texture  sides up to kLargestDdsSide, a BC format
FileHeader ddsHeader(const BlockTexture& texture);
TextureInFile ddsLayout(const BlockTexture& texture);

/// Reads and checks all that stands before the levels. Read are 2D textures of the BC formats that facezip writes, with
/// the DX10 header; the older ones do not say whether sRGB's curve is to be undone. Premultiplied alpha is refused.
/// Fields that the format's documentation tells readers not to trust (flags, capabilities, pitch) are not looked at.
/// path  for messages
/// Throws InputError naming the field.
TextureInFile readDds(const std::filesystem::path& path, const InputFile& file);

}  // namespace facezip::blocks
