// file_pieces.hpp - files of any size, a piece at a time.
#pragma once

#include <cstddef>
#include <functional>
#include <string_view>

#include "facezip/input_file.hpp"

namespace facezip::io {

/// Calls `visit` with what stands in `file`, from its first byte to its last, `bytes` of it at a time; the last piece
/// is what is left. Throws InputError where the file cannot be read, or has become shorter. path  for messages
void forEachPiece(const InputFile& file, const std::string& path, std::size_t bytes,
                  const std::function<void(std::string_view piece)>& visit);

}  // namespace facezip::io
