// hashed.hpp - data from a hash of a seed and a count: the same for tests and benchmarks, on every machine.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

namespace facezip::test {

/// SplitMix64 (Steele, Lea and Flood 2014).
class Hashed {
 public:
  explicit Hashed(std::uint64_t seed) : state_(seed) {}

  std::uint64_t bits() {
    std::uint64_t x = state_ += 0x9e3779b97f4a7c15u;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return x ^ (x >> 31);
  }
  /// In [0, 1).
  double unit() { return static_cast<double>(bits() >> 11) * 0x1.0p-53; }
  /// In [low, high), a float.
  float between(float low, float high) { return low + (high - low) * static_cast<float>(unit()); }
  /// In [0, end).
  int below(int end) { return static_cast<int>(bits() % static_cast<unsigned>(end)); }
  bool oneIn(int n) { return below(n) == 0; }

  void fill(std::span<std::byte> bytes) {
    while (!bytes.empty()) {
      const std::uint64_t word = bits();
      const std::size_t count = bytes.size() < sizeof(word) ? bytes.size() : sizeof(word);
      std::memcpy(bytes.data(), &word, count);
      bytes = bytes.subspan(count);
    }
  }

 private:
  std::uint64_t state_;
};

}  // namespace facezip::test
