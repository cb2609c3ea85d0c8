// wrinkles.hpp - where skin folds when it is compressed: a crease pattern that belongs to the subject.
#pragma once

#include <array>
#include <cstdint>

namespace facezip::synth {

constexpr std::size_t kCreaseScales = 3;
constexpr std::size_t kCreaseDirections = 8;

/// Fixed pattern of one skin point: for every scale and direction of compression, the height of fully formed creases
/// relative to their depth: -1 in a valley, slightly positive beside it.
struct CreasePattern {
  std::array<std::array<float, kCreaseDirections>, kCreaseScales> relief;
  float readiness;  ///< 0..1: how easily this part of the face creases
};

/// Creases of one skin point in one expression.
struct Creases {
  float height = 0.0f;   ///< metres, mostly negative
  float shading = 0.0f;  ///< relief summed over the scales, for colour: negative in valleys
};

class CreaseField {
 public:
  /// texel  size of a texel in metres: scales that it cannot show are left out
  CreaseField(std::uint64_t seed, float texel);

  /// The pattern at skin point (s, t), metres.
  CreasePattern pattern(float s, float t) const;

  /// Creases run across the direction of compression and form once it passes a threshold, coarse folds last.
  /// x, y  SkinState::compression_x and _y
  Creases fold(const CreasePattern& pattern, float x, float y) const;

 private:
  std::uint64_t seed_;
  std::array<float, kCreaseScales> visible_;  ///< 0..1 per scale
};

/// 1 where a texel is small enough to show a detail of that size (metres), 0 where it is not.
float detailVisible(float size, float texel);

}  // namespace facezip::synth
