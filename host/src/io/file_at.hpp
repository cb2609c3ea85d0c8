// file_at.hpp - bytes at a place of an open file, all of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace facezip::io {

/// Both go on where the kernel stops early, and move no file position: several threads may read one file. They return
/// what went wrong, for messages ("cut short" where the file ends before), or nothing.
std::string readAt(int descriptor, std::uint64_t offset, std::span<std::byte> bytes);
std::string writeAt(int descriptor, std::uint64_t offset, std::span<const std::byte> bytes);

}  // namespace facezip::io
