// noise.hpp - counter-based random numbers and band-limited noise.
// Every value is a function of its arguments alone, so that threads and bands cannot change a result.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string_view>

namespace facezip::synth {

/// Finaliser of SplitMix64 (Steele, Lea and Flood 2014): every input bit reaches every output bit.
constexpr std::uint64_t mixBits(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

/// A seed of its own for each use of a capture's seed: two patterns must not be shifted copies of each other.
constexpr std::uint64_t deriveSeed(std::uint64_t seed, std::string_view purpose) {
  std::uint64_t hash = mixBits(seed);
  for (const char c : purpose) hash = mixBits(hash ^ static_cast<unsigned char>(c));
  return hash;
}

/// A short sequence of random numbers.
class Random {
 public:
  explicit Random(std::uint64_t seed) : seed_(seed) {}
  std::uint64_t bits() { return mixBits(seed_ + 0x632be59bd9b4e019u * ++count_); }
  /// [0, 1)
  double uniform() { return static_cast<double>(bits() >> 11) * 0x1p-53; }
  double between(double low, double high) { return low + (high - low) * uniform(); }

 private:
  std::uint64_t seed_;
  std::uint64_t count_ = 0;
};

/// Sum of three 16-bit uniforms, scaled to mean 0 and variance 1: near enough to a Gaussian up to three sigma, and
/// free of log and cos, whose last bits differ between C libraries.
inline float approximateGaussian(std::uint64_t bits) {
  const auto sum = static_cast<float>((bits & 0xffff) + ((bits >> 16) & 0xffff) + ((bits >> 32) & 0xffff));
  return (sum / 65535.0f - 1.5f) * 2.0f;
}

/// 0 below `low`, 1 above `high`, with zero slope at both; low > high gives the falling step.
template <typename Real>
Real smoothStep(Real low, Real high, Real x) {
  const Real f = std::clamp((x - low) / (high - low), Real(0), Real(1));
  return f * f * (Real(3) - Real(2) * f);
}

/// a at f = 0, b at f = 1. std::lerp promises more than noise needs (exactness at both ends) and branches for it.
template <typename Real>
Real mix(Real a, Real b, Real f) {
  return a + f * (b - a);
}

/// exp(-x^2): a bump of half-width about 1.
template <typename Real>
Real bump(Real x) {
  return std::exp(-x * x);
}

/// Gradient noise (Perlin 2002) of one feature per unit: mean 0, rms about 0.30, within [-1, 1].
float gradientNoise(float x, float y, std::uint64_t seed);

/// `octaves` of gradient noise, each of twice the frequency and half the amplitude; rms about 0.35.
float fractalNoise(float x, float y, int octaves, std::uint64_t seed);

}  // namespace facezip::synth
