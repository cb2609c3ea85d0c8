#include "synth/noise.hpp"

#include <array>

namespace facezip::synth {
namespace {

struct Gradient {
  float x;
  float y;
};

// Sixteen directions; the table is written out because std::cos is not the same on every C library.
constexpr float kA = 0.92387953f, kB = 0.38268343f, kC = 0.70710678f;
constexpr std::array<Gradient, 16> kGradients = {{{1, 0},
                                                  {kA, kB},
                                                  {kC, kC},
                                                  {kB, kA},
                                                  {0, 1},
                                                  {-kB, kA},
                                                  {-kC, kC},
                                                  {-kA, kB},
                                                  {-1, 0},
                                                  {-kA, -kB},
                                                  {-kC, -kC},
                                                  {-kB, -kA},
                                                  {0, -1},
                                                  {kB, -kA},
                                                  {kC, -kC},
                                                  {kA, -kB}}};

float corner(std::int64_t column, std::int64_t row, float dx, float dy, std::uint64_t seed) {
  const std::uint64_t key = static_cast<std::uint64_t>(column) * 0x9e3779b97f4a7c15u ^
                            static_cast<std::uint64_t>(row) * 0xc2b2ae3d27d4eb4fu ^ seed;
  // One multiplication round is enough for noise: the seed is already mixed.
  const std::uint64_t hash = (key ^ (key >> 29)) * 0xbf58476d1ce4e5b9u;
  const Gradient& gradient = kGradients[hash >> 60];
  return gradient.x * dx + gradient.y * dy;
}

/// std::floor is a library call where SSE4.1 may not be assumed.
std::int64_t floorToInteger(float x) {
  const auto truncated = static_cast<std::int64_t>(x);
  return truncated - (static_cast<float>(truncated) > x ? 1 : 0);
}

float quintic(float f) { return f * f * f * (f * (f * 6.0f - 15.0f) + 10.0f); }

}  // namespace

float gradientNoise(float x, float y, std::uint64_t seed) {
  const std::int64_t column = floorToInteger(x);
  const std::int64_t row = floorToInteger(y);
  const float dx = x - static_cast<float>(column);
  const float dy = y - static_cast<float>(row);
  const float fx = quintic(dx);
  const float top = mix(corner(column, row, dx, dy, seed), corner(column + 1, row, dx - 1, dy, seed), fx);
  const float bottom =
      mix(corner(column, row + 1, dx, dy - 1, seed), corner(column + 1, row + 1, dx - 1, dy - 1, seed), fx);
  return 1.4142135f * mix(top, bottom, quintic(dy));
}

float fractalNoise(float x, float y, int octaves, std::uint64_t seed) {
  float sum = 0.0f;
  float amplitude = 1.0f;
  for (int octave = 0; octave < octaves; ++octave) {
    sum += amplitude * gradientNoise(x, y, seed + static_cast<std::uint64_t>(octave) * 0x9e3779b97f4a7c15u);
    // The shift keeps the lattice points, where the noise is zero, from falling on each other.
    x = 2.0f * x + 17.3f;
    y = 2.0f * y + 5.7f;
    amplitude *= 0.5f;
  }
  return sum;
}

}  // namespace facezip::synth
