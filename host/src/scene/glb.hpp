// glb.hpp - glTF's binary container: a header, a chunk of JSON and a chunk of bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace facezip::scene {

struct GlbParts {
  std::string json;
  std::span<const std::byte> binary;  ///< within what was split
};

/// Takes a file apart. Every length is checked; nothing but the two chunks may stand there.
/// bytes  of strangers. file  path for messages
/// Throws InputError.
GlbParts splitGlb(std::span<const std::byte> bytes, const std::string& file);

/// Puts one together. json and binary are of at most 2^31 bytes together.
std::string joinGlb(std::string json, std::span<const std::byte> binary);

}  // namespace facezip::scene
