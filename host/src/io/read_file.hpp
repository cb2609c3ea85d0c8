// read_file.hpp - small files, whole.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace facezip::io {

/// Far beyond any description, preset or guess that people write.
inline constexpr std::uintmax_t kMostBytes = std::uintmax_t{64} << 20;

/// What stands in `file`, byte for byte.
/// expected  what the file should be, for messages: "the description of a facezip package"
/// cure      what to do where it is not there
/// most      bytes that it may have
/// Throws InputError: no such file, no regular one, more bytes than that, one that cannot be read to its end.
std::string readFile(const std::filesystem::path& file, const std::string& expected, const std::string& cure = "",
                     std::uintmax_t most = kMostBytes);

}  // namespace facezip::io
