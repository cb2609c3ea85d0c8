// memory.hpp - how much a command may keep in memory.
#pragma once

#include <cstdint>

namespace facezip {

/// Of --memory, and of every memory_bytes, unless it is said otherwise.
inline constexpr std::uint64_t kDefaultMemoryBytes = std::uint64_t{2} << 30;

}  // namespace facezip
