// memory_bound.hpp - refuses what would take more memory than a command was given.
#pragma once

#include <cstdint>
#include <string>

namespace facezip::io {

/// What a process holds before it reads anything: OpenCL's compiler, image libraries. Measured with PoCL 3.1 (about 190
/// MiB) and rounded up.
inline constexpr std::uint64_t kProcessBytes = std::uint64_t{256} << 20;

/// Throws InputError where `needed` bytes, beside what a process holds anyway, are more than `memory_bytes`.
/// what  needs them, for the message: "the mesh of face.facezip"
void requireMemory(std::uint64_t needed, std::uint64_t memory_bytes, const std::string& what);

}  // namespace facezip::io
