// counter_hash.hpp - random numbers as a function of a seed and three counters, the same on the host and in kernels.
#pragma once

#include <cstdint>

#include "cl/counter_hash.h"

namespace facezip::compress {

/// 64 random bits of draw `draw` of item (`major`, `minor`) under `seed`.
constexpr std::uint64_t counterHash(std::uint64_t seed, std::uint64_t major, std::uint64_t minor, std::uint64_t draw) {
  return facezip_counter_hash(seed, major, minor, draw);
}

/// Maps 64 random bits to 0 .. count - 1; `count` below 2^32. The bias is below count / 2^32.
constexpr std::uint32_t boundedDraw(std::uint64_t bits, std::uint32_t count) {
  return static_cast<std::uint32_t>(((bits >> 32) * count) >> 32);
}

}  // namespace facezip::compress
