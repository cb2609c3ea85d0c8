// ktx2_file.hpp - KTX 2.0 (Khronos), the container of three.js, Godot and glTF tools, for 2D textures of blocks.
// In front of the blocks: identifier, header, an index of levels, the data format descriptor, keys with values. Then
// the levels, the smallest first, each aligned to its blocks; between them zeros. The specification leaves no freedom
// in where things lie, so that all places follow from format, sizes and the length of the keys.
#pragma once

#include <filesystem>

#include "blocks/file_header.hpp"

namespace facezip::blocks {

inline constexpr int kLargestKtx2Side = 65536;

/// Keys: KTXorientation "rd" (row 0 is the upper one) and KTXwriter "facezip VERSION".
/// Primaries of the descriptor are BT.709 with sRGB's curve, else unspecified: differences, normals and the like are no
/// colours, and loaders shall not convert them.
/// texture  sides up to kLargestKtx2Side
FileHeader ktx2Header(const BlockTexture& texture);
TextureInFile ktx2Layout(const BlockTexture& texture);

/// Reads and checks all that stands before the levels. Read are 2D textures of the formats that facezip writes, without
/// supercompression, as the specification wants them, with up to 64 KiB of keys. Turned textures (KTXorientation other
/// than "rd"), swizzles and premultiplied alpha are refused, since what samples mean would be another.
/// path  for messages
/// Throws InputError naming the field.
TextureInFile readKtx2(const std::filesystem::path& path, const InputFile& file);

}  // namespace facezip::blocks
