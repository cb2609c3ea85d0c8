// counter_hash.h - random numbers as a function of a seed and three counters; C that kernels and host compile.
// No state: the draw of a restart is the same whatever thread or work-item asks for it, and on every platform.
#ifndef FACEZIP_COUNTER_HASH_H
#define FACEZIP_COUNTER_HASH_H

#ifdef __OPENCL_VERSION__
#define FACEZIP_HASH ulong
#define FACEZIP_HASH_FUNCTION inline ulong
#else
#include <cstdint>
#define FACEZIP_HASH std::uint64_t
#define FACEZIP_HASH_FUNCTION constexpr std::uint64_t
#endif

// Finaliser of SplitMix64 (Steele, Lea and Flood 2014): a bijection of 64-bit words that passes BigCrush on a counter.
FACEZIP_HASH_FUNCTION facezip_mix_bits(FACEZIP_HASH x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9UL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebUL;
  return x ^ (x >> 31);
}

// 64 random bits of draw `draw` of item (`major`, `minor`) under `seed`. The step between counters is odd, so that they
// stay distinct.
FACEZIP_HASH_FUNCTION facezip_counter_hash(FACEZIP_HASH seed, FACEZIP_HASH major, FACEZIP_HASH minor, FACEZIP_HASH draw) {
  FACEZIP_HASH step = 0x9e3779b97f4a7c15UL;
  FACEZIP_HASH hash = facezip_mix_bits(seed + step);
  hash = facezip_mix_bits(hash + (major + 1) * step);
  hash = facezip_mix_bits(hash + (minor + 1) * step);
  return facezip_mix_bits(hash + (draw + 1) * step);
}

#endif
