// counter_hash.hpp - random numbers as a function of a seed and three counters.
// No state: the draw of a restart is the same whatever thread or work-item asks for it, and on every platform.
// kernels/cl/kmeans.cl holds the same function for the device.
#pragma once

#include <cstdint>

namespace facezip::compress {

/// Finaliser of SplitMix64 (Steele, Lea and Flood 2014): a bijection of 64-bit words that passes BigCrush on a counter.
constexpr std::uint64_t mixBits(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

/// 64 random bits of draw `draw` of item (`major`, `minor`) under `seed`.
constexpr std::uint64_t counterHash(std::uint64_t seed, std::uint64_t major, std::uint64_t minor, std::uint64_t draw) {
  constexpr std::uint64_t kGolden = 0x9e3779b97f4a7c15u;  // odd, so that counters stay distinct
  std::uint64_t hash = mixBits(seed + kGolden);
  hash = mixBits(hash + (major + 1) * kGolden);
  hash = mixBits(hash + (minor + 1) * kGolden);
  return mixBits(hash + (draw + 1) * kGolden);
}

/// Maps 64 random bits to 0 .. count - 1; `count` below 2^32. The bias is below count / 2^32.
constexpr std::uint32_t boundedDraw(std::uint64_t bits, std::uint32_t count) {
  return static_cast<std::uint32_t>(((bits >> 32) * count) >> 32);
}

}  // namespace facezip::compress
