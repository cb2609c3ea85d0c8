// skin.hpp - what does not change when the face moves: colour, pores, hair.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "synth/head_shape.hpp"

namespace facezip::synth {

/// Fixed properties of one skin point. Colours are logarithms of linear reflectance, so that pigment, blood and
/// shadow add (Beer-Lambert).
struct SkinSample {
  std::array<float, 3> log_colour{};  ///< R, G, B, linear light
  float height = 0.0f;                ///< metres: pores, lip lines and fine relief
  float blood = 1.0f;                 ///< how much blood vessels react here, 0 under hair
  float oil = 0.5f;                   ///< 0 dry .. 1 oily, for specular and roughness
};

/// A stroke of hair as a circular-ish arc, metres on the skin.
struct Hair {
  float s0, t0, s1, t1, s2, t2;  ///< root, middle, tip
  float width;
};

/// Skin of one subject as a function of the skin point.
class Skin {
 public:
  /// texel  size of a texel in metres: details that it cannot show are faded out
  Skin(std::uint64_t seed, const Landmarks& landmarks, float texel);

  SkinSample sample(float s, float t) const;
  /// How much a flush of the face reddens this point, 0..1: cheeks, nose, chin.
  float flushMap(float s, float t) const;

  /// How much the logarithm of R, G, B falls per unit of melanin or haemoglobin.
  static constexpr std::array<float, 3> kMelanin = {0.35f, 0.65f, 0.95f};
  static constexpr std::array<float, 3> kHaemoglobin = {0.10f, 0.62f, 0.55f};

 private:
  struct Spot {
    float s, t, radius, melanin;
  };

  float lipMask(float s, float t) const;

  float freckles(float s, float t) const;
  float pores(float s, float t, float* height) const;
  float moles(float s, float t) const;
  float browHair(float s, float t) const;
  float shortHair(float s, float t) const;
  void growBrows();

  std::uint64_t seed_;
  Landmarks landmarks_;
  float texel_;
  float melanin_, haemoglobin_, freckling_, stubble_, hair_darkness_, lip_red_;
  std::vector<Spot> moles_;
  /// Brow hairs that may touch a column of the left brow, and of the right one.
  static constexpr std::size_t kBrowColumns = 48;
  std::array<std::array<std::vector<Hair>, kBrowColumns>, 2> brows_;
};

}  // namespace facezip::synth
