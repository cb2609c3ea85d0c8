#include "synth/skin.hpp"

#include <algorithm>
#include <cmath>

#include "synth/noise.hpp"
#include "synth/wrinkles.hpp"

namespace facezip::synth {
namespace {

// Reflectance without pigment and blood.
constexpr std::array<float, 3> kLogBase = {-0.20f, -0.43f, -0.60f};

constexpr float kBrowInner = 0.0105f;
constexpr float kBrowOuter = 0.0520f;

float spot(float ds, float dt, float radius_s, float radius_t) { return bump(ds / radius_s) * bump(dt / radius_t); }

/// Height of the brow's middle line above the landmark, f = 0 at the nose, 1 at the temple.
float browArch(float f) { return 0.0045f * std::sin(2.4f * f + 0.1f) - 0.0050f * f * f * f * f; }

float segmentDistance(float s, float t, float s0, float t0, float s1, float t1, float* share) {
  const float ds = s1 - s0;
  const float dt = t1 - t0;
  *share = std::clamp(((s - s0) * ds + (t - t0) * dt) / (ds * ds + dt * dt), 0.0f, 1.0f);
  return std::hypot(s - s0 - *share * ds, t - t0 - *share * dt);
}

struct CellPoint {
  float distance;  ///< in cells
  std::uint64_t hash;
};

/// Nearest of one random point per unit cell (Worley 1996, first feature).
CellPoint nearestCellPoint(float x, float y, std::uint64_t seed) {
  const auto column = static_cast<std::int64_t>(std::floor(x));
  const auto row = static_cast<std::int64_t>(std::floor(y));
  CellPoint nearest{9.0f, 0};
  for (std::int64_t j = row - 1; j <= row + 1; ++j) {
    for (std::int64_t i = column - 1; i <= column + 1; ++i) {
      const std::uint64_t hash = mixBits(static_cast<std::uint64_t>(i) * 0x9e3779b97f4a7c15u ^
                                         static_cast<std::uint64_t>(j) * 0xc2b2ae3d27d4eb4fu ^ seed);
      const float px = static_cast<float>(i) + static_cast<float>(hash & 0xffff) / 65536.0f;
      const float py = static_cast<float>(j) + static_cast<float>((hash >> 16) & 0xffff) / 65536.0f;
      const float distance = (px - x) * (px - x) + (py - y) * (py - y);
      if (distance < nearest.distance) nearest = {distance, hash >> 32};
    }
  }
  nearest.distance = std::sqrt(nearest.distance);
  return nearest;
}

}  // namespace

Skin::Skin(std::uint64_t seed, const Landmarks& landmarks, float texel)
    : seed_(deriveSeed(seed, "skin")), landmarks_(landmarks), texel_(texel) {
  Random random(deriveSeed(seed, "complexion"));
  melanin_ = static_cast<float>(0.25 + 1.15 * std::pow(random.uniform(), 1.7));
  haemoglobin_ = static_cast<float>(random.between(0.36, 0.56));
  freckling_ = static_cast<float>(random.between(0.0, 0.5) * (melanin_ < 0.7f ? 1.0 : 0.3));
  stubble_ = static_cast<float>(std::max(0.0, random.between(-0.5, 0.5)));
  hair_darkness_ = static_cast<float>(random.between(1.2, 2.2));
  lip_red_ = static_cast<float>(random.between(0.50, 0.80));
  for (int i = 0; i < 14; ++i) {
    moles_.push_back({static_cast<float>(random.between(-0.09, 0.09)), static_cast<float>(random.between(-0.09, 0.13)),
                      static_cast<float>(random.between(0.0006, 0.0014)),
                      static_cast<float>(random.between(0.4, 1.3))});
  }
  growBrows();
}

void Skin::growBrows() {
  Random random(deriveSeed(seed_, "brows"));
  for (std::size_t side = 0; side < 2; ++side) {
    const double sign = side == 0 ? 1.0 : -1.0;
    for (int i = 0; i < 420; ++i) {
      const double f = random.uniform();
      const double half_height = 0.0042 * (1.0 - 0.75 * f) * (0.4 + 0.6 * smoothStep(0.0, 0.12, f));
      const double s = kBrowInner + (kBrowOuter - kBrowInner) * f;
      const double t = landmarks_.brow_t + browArch(static_cast<float>(f)) + half_height * random.between(-1.0, 1.0);
      // Upright beside the nose, lying along the brow towards the temple.
      const double angle = 1.45 - 1.65 * smoothStep(0.0, 0.45, f) - 0.25 * f + random.between(-0.25, 0.25);
      const double length = random.between(0.0040, 0.0085);
      const double bend = random.between(-0.35, 0.05);
      const double ms = s + 0.5 * length * std::cos(angle);
      const double mt = t + 0.5 * length * std::sin(angle);
      const Hair hair{static_cast<float>(sign * s),
                      static_cast<float>(t),
                      static_cast<float>(sign * ms),
                      static_cast<float>(mt),
                      static_cast<float>(sign * (ms + 0.5 * length * std::cos(angle + bend))),
                      static_cast<float>(mt + 0.5 * length * std::sin(angle + bend)),
                      static_cast<float>(random.between(0.00011, 0.00019))};
      const double span = (kBrowOuter + 0.010 - kBrowInner + 0.004) / kBrowColumns;
      const int first = static_cast<int>((s - kBrowInner + 0.002) / span);
      for (int column = std::max(0, first);
           column <= std::min<int>(kBrowColumns - 1, first + static_cast<int>(0.010 / span)); ++column) {
        brows_[side][static_cast<std::size_t>(column)].push_back(hair);
      }
    }
  }
}

float Skin::browHair(float s, float t) const {
  const float side = std::abs(s);
  const float span = (kBrowOuter + 0.010f - kBrowInner + 0.004f) / kBrowColumns;
  const float column = (side - kBrowInner + 0.002f) / span;
  const auto brow_t = static_cast<float>(landmarks_.brow_t);
  if (column < 0.0f || column >= kBrowColumns || t < brow_t - 0.016f || t > brow_t + 0.022f) return 0.0f;
  // A hair thinner than a texel keeps its share of the texel instead of vanishing.
  float clear = 1.0f;
  for (const Hair& hair : brows_[s > 0.0f ? 0 : 1][static_cast<std::size_t>(column)]) {
    float share0, share1;
    const float d0 = segmentDistance(s, t, hair.s0, hair.t0, hair.s1, hair.t1, &share0);
    const float d1 = segmentDistance(s, t, hair.s1, hair.t1, hair.s2, hair.t2, &share1);
    const float taper = d0 < d1 ? 1.0f : 1.0f - 0.7f * share1;
    const float width = std::max(hair.width * taper, 0.55f * texel_);
    clear *= 1.0f - 0.85f * (hair.width * taper / width) * bump(std::min(d0, d1) / width);
  }
  return 1.0f - clear;
}

float Skin::lipMask(float s, float t) const {
  const float x = s / static_cast<float>(landmarks_.mouth_half_width + 0.0015);
  if (std::abs(x) >= 1.0f) return 0.0f;
  const float across = std::pow(1.0f - x * x, 0.62f);
  const float bow = 1.0f - 0.20f * bump(s / 0.0034f) + 0.10f * bump((std::abs(s) - 0.0065f) / 0.0040f);
  const float border = t > 0.0f ? 0.0076f * across * bow : 0.0096f * across;
  const float wobble = 0.0004f * gradientNoise(s / 0.003f, t / 0.003f, seed_ + 40);
  return smoothStep(border + 0.0007f, border - 0.0007f, std::abs(t) + wobble);
}

float Skin::flushMap(float s, float t) const {
  const float side = std::abs(s);
  const float cheeks = spot(side - 0.044f, t - 0.028f, 0.022f, 0.018f);
  const float nose =
      0.9f * spot(s, t - 0.028f, 0.013f, 0.010f) + 0.5f * spot(side - 0.013f, t - 0.024f, 0.006f, 0.007f);
  const float chin = 0.45f * spot(s, t + 0.032f, 0.015f, 0.011f);
  const float ears = 0.6f * smoothStep(0.105f, 0.140f, side) * bump((t - 0.045f) / 0.035f);
  const float lids = 0.35f * spot(side - 0.030f, t - 0.069f, 0.017f, 0.008f);
  return cheeks + nose + chin + ears + lids;
}

float Skin::freckles(float s, float t) const {
  const float visible = detailVisible(0.0012f, texel_);
  const float where = spot(std::abs(s) - 0.030f, t - 0.038f, 0.034f, 0.024f) + 0.25f;
  if (visible * freckling_ == 0.0f) return 0.0f;
  const CellPoint cell = nearestCellPoint(s / 0.0030f, t / 0.0030f, seed_ + 20);
  const float chance = static_cast<float>(cell.hash & 0xffff) / 65536.0f;
  if (chance > 1.2f * freckling_ * where) return 0.0f;
  const float radius = 0.10f + 0.16f * static_cast<float>((cell.hash >> 16) & 0xffff) / 65536.0f;
  return visible * 0.30f * smoothStep(1.4f * radius, 0.6f * radius, cell.distance);
}

float Skin::moles(float s, float t) const {
  float melanin = 0.0f;
  for (const Spot& mole : moles_) {
    const float distance = std::hypot(s - mole.s, t - mole.t);
    if (distance > 2.5f * mole.radius) continue;
    const float ragged = 1.0f + 0.35f * gradientNoise(s / 0.0012f, t / 0.0012f, seed_ + 21);
    melanin += mole.melanin * smoothStep(1.25f * mole.radius, 0.7f * mole.radius, distance * ragged);
  }
  return melanin;
}

float Skin::pores(float s, float t, float* height) const {
  // Wide on nose and cheeks, fine elsewhere.
  const float coarse = std::min(
      1.0f, spot(s, t - 0.034f, 0.018f, 0.020f) + 0.8f * spot(std::abs(s) - 0.030f, t - 0.030f, 0.018f, 0.018f));
  const float visible = detailVisible(0.00085f, texel_);
  if (visible == 0.0f) return 0.0f;
  const CellPoint cell = nearestCellPoint(s / 0.00105f, t / 0.00105f, seed_ + 22);
  const float size = 0.16f + 0.20f * static_cast<float>(cell.hash & 0xffff) / 65536.0f;
  const float pore = visible * smoothStep(size * 1.5f, size * 0.4f, cell.distance) * (0.30f + 0.70f * coarse);
  *height -= 0.000035f * pore;
  return pore;
}

float Skin::shortHair(float s, float t) const {
  const float side = std::abs(s);
  const float ragged = 0.004f * fractalNoise(s / 0.012f, t / 0.012f, 3, seed_ + 30);
  const float hairline =
      0.143f - 0.55f * std::max(0.0f, side - 0.050f) + 0.25f * bump((side - 0.045f) / 0.018f) * 0.05f;
  const float scalp = smoothStep(-0.002f, 0.006f, t - hairline + ragged);
  const float sideburn = smoothStep(0.100f, 0.106f, side + ragged) * smoothStep(0.020f, 0.045f, t);
  const float beard_s =
      smoothStep(0.112f, 0.095f, side + ragged) *
      std::max(bump((t + 0.035f) / 0.035f), smoothStep(0.045f, 0.085f, side) * bump((t + 0.005f) / 0.04f));
  const float moustache = spot(side - 0.014f, t - 0.011f, 0.018f, 0.006f);
  const float beard = stubble_ * std::clamp(std::max(beard_s, moustache), 0.0f, 1.0f) * (1.0f - lipMask(s, t));
  const float density = std::max({scalp, sideburn, beard});
  if (density <= 0.0f) return 0.0f;
  // Cropped hair: dark dashes that lie downwards and backwards.
  const float lean = 0.35f * s / 0.1f;
  const float strands = fractalNoise((s - lean * t) / 0.0011f, (t + lean * s) / 0.0055f, 2, seed_ + 31);
  const float shown = mix(0.35f, smoothStep(-0.45f, 0.60f, strands), detailVisible(0.0012f, texel_));
  return density * (0.45f + 0.55f * shown);
}

SkinSample Skin::sample(float s, float t) const {
  const float lip = lipMask(s, t);
  const float hair = std::max(browHair(s, t), 0.50f * shortHair(s, t));
  SkinSample skin;
  skin.height = 0.000016f * detailVisible(0.0016f, texel_) * fractalNoise(s / 0.0016f, t / 0.0016f, 2, seed_ + 10);
  const float pore = pores(s, t, &skin.height) * (1.0f - lip);

  const float mottled = fractalNoise(s / 0.016f, t / 0.016f, 5, seed_ + 11);
  const float blotched = fractalNoise(s / 0.007f, t / 0.007f, 4, seed_ + 12);
  const float around_eye = spot(std::abs(s) - 0.029f, t - 0.058f, 0.017f, 0.009f);
  const float mole = moles(s, t);
  float melanin = melanin_ * (1.0f + 0.16f * mottled + 0.16f * around_eye + 0.10f * lip) + freckles(s, t) + mole;
  float blood = haemoglobin_ * (1.0f + 0.26f * blotched) + 0.20f * flushMap(s, t) + 0.10f * pore + lip_red_ * lip;
  melanin += 0.10f * pore;

  const float lines = fractalNoise(s / 0.0013f, t / 0.012f, 2, seed_ + 13) * detailVisible(0.0013f, texel_);
  blood += 0.22f * lip * lines;
  skin.height += 0.00007f * lip * lines;
  // Lashes and the wet rim: a dark line around the eyes.
  const float eye_s =
      (std::abs(s) - static_cast<float>(landmarks_.eye_s)) / static_cast<float>(landmarks_.eye_half_width);
  const float open = std::max(0.0f, 1.0f - eye_s * eye_s);
  const float dt = t - static_cast<float>(landmarks_.eye_t);
  const float upper = bump((dt - static_cast<float>(landmarks_.upper_lid_height) * open) / 0.0011f);
  const float lower = bump((dt + static_cast<float>(landmarks_.lower_lid_height) * open) / 0.0008f);
  const float lashes = std::abs(eye_s) < 1.08f ? std::max(1.1f * upper, 0.45f * lower) : 0.0f;
  const float nostril = 1.5f * spot(std::abs(s) - 0.0068f, t - 0.0180f, 0.0040f, 0.0024f);
  const float mouth_line = 0.6f * bump(t / 0.0011f) * smoothStep(0.0275f, 0.0235f, std::abs(s));

  for (std::size_t c = 0; c < 3; ++c) {
    const float shadow = (nostril + mouth_line) * (c == 0 ? 0.55f : 0.8f) + lashes + 0.35f * mole;
    skin.log_colour[c] = kLogBase[c] - melanin * kMelanin[c] - blood * kHaemoglobin[c] -
                         hair * hair_darkness_ * (c == 0 ? 0.85f : 1.0f) - shadow;
  }
  skin.height += 0.00010f * hair;
  skin.blood = 1.0f - 0.8f * hair;
  skin.oil = std::clamp(
      0.45f + 0.25f * spot(s, t - 0.05f, 0.016f, 0.06f) + 0.15f * lip + 0.10f * mottled - 0.25f * pore - 0.2f * hair,
      0.0f, 1.0f);
  return skin;
}

}  // namespace facezip::synth
