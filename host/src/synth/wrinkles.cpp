#include "synth/wrinkles.hpp"

#include <cmath>
#include <numbers>

#include "synth/noise.hpp"

namespace facezip::synth {
namespace {

struct CreaseScale {
  float spacing;    ///< metres between creases
  float threshold;  ///< compression at which they begin
  float full;       ///< compression at which they are complete
  float depth;      ///< metres
  float darkness;   ///< weight in the shading
};

constexpr std::array<CreaseScale, kCreaseScales> kScales = {{{0.0068f, 0.055f, 0.27f, 0.00050f, 1.0f},
                                                             {0.0036f, 0.040f, 0.22f, 0.00026f, 0.75f},
                                                             {0.0018f, 0.030f, 0.18f, 0.00011f, 0.5f}}};
constexpr float kElongation = 5.0f;  // length of a crease over its spacing

std::array<std::array<float, 2>, kCreaseDirections> makeDirections() {
  std::array<std::array<float, 2>, kCreaseDirections> directions{};
  for (std::size_t k = 0; k < kCreaseDirections; ++k) {
    const double angle = std::numbers::pi * static_cast<double>(k) / kCreaseDirections;
    directions[k] = {static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle))};
  }
  return directions;
}

/// Creases are the zero crossings of noise that is stretched along them: narrow valleys with a bulge on both sides.
/// From a table: 24 profiles per texel would spend most of their time in exp().
class CreaseProfile {
 public:
  CreaseProfile() {
    for (std::size_t i = 0; i < table_.size(); ++i) {
      const float noise = static_cast<float>(i) / kPerUnit;
      const float valley = bump(noise / 0.14f);
      const float bulge = bump(noise / 0.38f) - valley;
      table_[i] = 0.45f * bulge - valley;
    }
  }
  float operator()(float noise) const {
    const float position = std::min(std::abs(noise) * kPerUnit, static_cast<float>(table_.size() - 2));
    const auto index = static_cast<std::size_t>(position);
    return mix(table_[index], table_[index + 1], position - static_cast<float>(index));
  }

 private:
  static constexpr float kPerUnit = 256.0f;
  std::array<float, 258> table_;
};

float readinessAt(float s, float t) {
  const float side = std::abs(s);
  const auto spot = [&](float at_s, float at_t, float radius_s, float radius_t) {
    return bump((side - at_s) / radius_s) * bump((t - at_t) / radius_t);
  };
  const float forehead = 0.9f * spot(0.0f, 0.112f, 0.045f, 0.022f);
  const float glabella = 0.9f * spot(0.0f, 0.080f, 0.014f, 0.016f);
  const float crows_feet = spot(0.054f, 0.064f, 0.014f, 0.016f);
  const float under_eye = 0.8f * spot(0.032f, 0.052f, 0.020f, 0.010f);
  const float nose = 0.9f * spot(0.006f, 0.058f, 0.010f, 0.014f);
  const float fold = 0.9f * spot(0.030f, 0.012f, 0.012f, 0.022f);
  const float chin = 0.6f * spot(0.0f, -0.030f, 0.018f, 0.014f);
  const float strongest = std::max({forehead, glabella, crows_feet, under_eye, nose, fold, chin});
  // The throat folds softly: it would otherwise outweigh the face whenever the jaw opens.
  const float throat = mix(0.30f, 1.0f, smoothStep(-0.072f, -0.040f, t));
  return throat * (0.50f + 0.50f * strongest);
}

}  // namespace

float detailVisible(float size, float texel) { return smoothStep(1.5f, 3.0f, size / texel); }

CreaseField::CreaseField(std::uint64_t seed, float texel) : seed_(deriveSeed(seed, "creases")) {
  for (std::size_t scale = 0; scale < kCreaseScales; ++scale)
    visible_[scale] = detailVisible(kScales[scale].spacing, texel);
}

CreasePattern CreaseField::pattern(float s, float t) const {
  static const auto directions = makeDirections();
  static const CreaseProfile crease_profile;
  // Bent a little, or creases would be ruled with a straight-edge.
  const float warp_s = s + 0.0016f * gradientNoise(s / 0.011f, t / 0.011f, seed_ + 1);
  const float warp_t = t + 0.0016f * gradientNoise(s / 0.011f, t / 0.011f, seed_ + 2);
  CreasePattern pattern{};
  for (std::size_t scale = 0; scale < kCreaseScales; ++scale) {
    if (visible_[scale] == 0.0f) continue;
    const float across = 1.0f / kScales[scale].spacing;
    const float along = across / kElongation;
    // No two creases are equally deep.
    const float depth = 0.75f + 0.9f * gradientNoise(0.3f * across * s, 0.3f * across * t, seed_ + 3 + scale);
    for (std::size_t k = 0; k < kCreaseDirections; ++k) {
      const auto [cosine, sine] = directions[k];
      const float noise = gradientNoise(across * (cosine * warp_s + sine * warp_t),
                                        along * (cosine * warp_t - sine * warp_s), seed_ + 16 * (k + 1) + scale);
      pattern.relief[scale][k] = visible_[scale] * std::max(depth, 0.1f) * crease_profile(noise);
    }
  }
  const float variation = 1.0f + 0.5f * fractalNoise(s / 0.02f, t / 0.02f, 2, seed_ + 6);
  pattern.readiness = readinessAt(s, t) * std::clamp(variation, 0.4f, 1.5f);
  return pattern;
}

Creases CreaseField::fold(const CreasePattern& pattern, float x, float y) const {
  const float compression = std::sqrt(x * x + y * y);
  Creases creases;
  if (compression <= kScales[kCreaseScales - 1].threshold) return creases;
  // The doubled angle of the tensor halves here; between two neighbouring directions the patterns are blended.
  float turn = std::atan2(y, x) * static_cast<float>(0.5 / std::numbers::pi);
  if (turn < 0.0f) turn += 1.0f;
  const float position = turn * kCreaseDirections;
  const std::size_t first = static_cast<std::size_t>(position) % kCreaseDirections;
  const std::size_t second = (first + 1) % kCreaseDirections;
  const float share = smoothStep(0.2f, 0.8f, position - std::floor(position));
  for (std::size_t scale = 0; scale < kCreaseScales; ++scale) {
    const float formed = smoothStep(kScales[scale].threshold, kScales[scale].full, compression) * pattern.readiness;
    if (formed == 0.0f) continue;
    const float relief = formed * mix(pattern.relief[scale][first], pattern.relief[scale][second], share);
    creases.height += kScales[scale].depth * relief;
    creases.shading += kScales[scale].darkness * relief;
  }
  return creases;
}

}  // namespace facezip::synth
