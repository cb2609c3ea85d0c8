// read_file.hpp - small files, whole.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>

namespace facezip::io {

/// What stands in `file`, byte for byte.
/// expected  what the file should be, for messages: "the description of a facezip package"
/// cure      what to do where it is not there
/// most      bytes that it may have
/// Throws InputError: no such file, not a file, more bytes than that, one that cannot be read to its end.
std::string readFile(const std::filesystem::path& file, const std::string& expected, const std::string& cure = "",
                     std::uintmax_t most = std::numeric_limits<std::uintmax_t>::max());

}  // namespace facezip::io
