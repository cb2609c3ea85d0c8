#include "synth/head_shape.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "synth/noise.hpp"

namespace facezip::synth {
namespace {

/// One horizontal section of the head without features: an oval around the y axis.
struct Section {
  double y;           ///< height
  double depth;       ///< z of the midline
  double half_width;  ///< x of the widest point
};

// Sections at equal steps along the profile, from the throat over chin, lips and brow to the scalp; metres. Equal
// steps make t an arc length.
constexpr double kSectionStep = 0.0165;
constexpr std::array<Section, 18> kSections = {{{-0.128, 0.038, 0.050},
                                                {-0.114, 0.045, 0.051},
                                                {-0.101, 0.055, 0.053},
                                                {-0.093, 0.070, 0.057},
                                                {-0.084, 0.084, 0.060},
                                                {-0.070, 0.089, 0.063},
                                                {-0.055, 0.087, 0.066},
                                                {-0.040, 0.089, 0.0685},
                                                {-0.023, 0.089, 0.070},
                                                {-0.006, 0.088, 0.073},
                                                {0.011, 0.088, 0.075},
                                                {0.028, 0.088, 0.077},
                                                {0.045, 0.091, 0.078},
                                                {0.062, 0.093, 0.079},
                                                {0.079, 0.090, 0.078},
                                                {0.095, 0.083, 0.073},
                                                {0.108, 0.072, 0.064},
                                                {0.117, 0.058, 0.052}}};
constexpr double kMetresPerRadian = 0.078;

/// The section at height t: a uniform cubic B-spline, smooth enough for shading and free of overshoot.
Section sectionAt(double t, double bottom) {
  const double position = std::clamp((t - bottom) / kSectionStep, 0.0, static_cast<double>(kSections.size() - 1));
  const int interval = std::min(static_cast<int>(position), static_cast<int>(kSections.size()) - 2);
  const double f = position - interval;
  const std::array<double, 4> weights = {(1 - f) * (1 - f) * (1 - f) / 6, (3 * f * f * f - 6 * f * f + 4) / 6,
                                         (-3 * f * f * f + 3 * f * f + 3 * f + 1) / 6, f * f * f / 6};
  Section section{0, 0, 0};
  for (int k = 0; k < 4; ++k) {
    const int index = std::clamp(interval + k - 1, 0, static_cast<int>(kSections.size()) - 1);
    const Section& knot = kSections[static_cast<std::size_t>(index)];
    section.y += weights[static_cast<std::size_t>(k)] * knot.y;
    section.depth += weights[static_cast<std::size_t>(k)] * knot.depth;
    section.half_width += weights[static_cast<std::size_t>(k)] * knot.half_width;
  }
  return section;
}

/// exp(-x^4): a bump with a flat top.
double plateau(double x) { return std::exp(-x * x * x * x); }

double bump2(double s, double t, double radius_s, double radius_t) { return bump(s / radius_s) * bump(t / radius_t); }

}  // namespace

HeadShape::HeadShape(std::uint64_t seed) : noise_seed_(deriveSeed(seed, "shape noise")) {
  Random random(deriveSeed(seed, "proportions"));
  width_ = random.between(0.96, 1.04);
  jaw_width_ = random.between(0.92, 1.08);
  nose_length_ = random.between(0.88, 1.15);
  nose_width_ = random.between(0.90, 1.18);
  lip_fullness_ = random.between(0.75, 1.30);
  brow_ridge_ = random.between(0.6, 1.3);
  cheekbone_ = random.between(0.6, 1.4);
  chin_ = random.between(0.7, 1.3);
}

double HeadShape::halfWidth(double t) {
  const double corner = std::pow(std::abs((t - 0.025) / 0.1405), 4);
  return kMetresPerRadian * (1.86 - 0.52 * corner);
}

double HeadShape::noseHeight(double s, double t) const {
  // Along the midline: a straight bridge, a rounded tip and a short steep base.
  const double bridge = smoothStep(0.074, 0.031, t);
  const double base = smoothStep(0.0135, 0.0265, t);
  const double ridge_width = nose_width_ * mix(0.0100, 0.0070, smoothStep(0.030, 0.056, t));
  const double ridge = 0.0205 * nose_length_ * bridge * base * bump(s / ridge_width);
  const double tip = 0.0045 * nose_length_ * bump2(s, t - 0.030, 0.0075, 0.0065);
  const double wing = 0.0080 * bump((std::abs(s) - 0.0125 * nose_width_) / 0.0068) * smoothStep(0.0130, 0.0240, t) *
                      smoothStep(0.041, 0.026, t);
  const double nostril = -0.0045 * bump2(std::abs(s) - 0.0068 * nose_width_, t - 0.0175, 0.0042, 0.0030);
  return ridge + tip + wing + nostril;
}

double HeadShape::eyeRelief(double s, double t) const {
  const double ds = std::abs(s) - landmarks_.eye_s;
  const double dt = t - landmarks_.eye_t;
  const double socket = -0.0105 * bump2(ds + 0.002, dt - 0.001, 0.0190, 0.0135);
  const double ball = 0.0085 * bump2(ds, dt, 0.0130, 0.0105);
  const double crease = -0.0014 * bump(((dt - 0.0125) - 12.0 * ds * ds) / 0.0022) * plateau(ds / 0.0150);
  const double ridge = 0.0045 * brow_ridge_ * plateau((std::abs(s) - 0.029) / 0.024) * bump((t - 0.082) / 0.0095);
  const double nasion = -0.0030 * bump2(s, t - 0.070, 0.0100, 0.0080);
  return socket + ball + crease + ridge + nasion;
}

double HeadShape::lipRelief(double s, double t) const {
  const double across = plateau(s / 0.0235);
  const double mound = 0.0055 * bump(s / 0.033) * bump((t - 0.001) / 0.0190);
  const double upper = 0.0042 * lip_fullness_ * across * bump((t - 0.0042) / 0.0040) * (1.0 - 0.25 * bump(s / 0.0035));
  const double lower = 0.0052 * lip_fullness_ * across * bump((t + 0.0050) / 0.0048);
  const double line = -0.0034 * plateau(s / 0.0265) * bump(t / 0.0019);
  const double philtrum =
      -0.0016 * bump2(s, t - 0.0135, 0.0034, 0.0060) + 0.0008 * bump2(std::abs(s) - 0.0062, t - 0.0125, 0.0026, 0.0060);
  const double chin_fold = -0.0042 * bump2(s, t + 0.0165, 0.0190, 0.0065);
  const double corner = -0.0020 * bump2(std::abs(s) - 0.0275, t + 0.0010, 0.0045, 0.0050);
  return mound + upper + lower + line + philtrum + chin_fold + corner;
}

double HeadShape::cheekRelief(double s, double t) const {
  const double side = std::abs(s);
  const double cheekbone = 0.0055 * cheekbone_ * bump2(side - 0.050, t - 0.042, 0.0200, 0.0160);
  const double hollow = -0.0050 * bump2(side - 0.062, t - 0.004, 0.0200, 0.0220);
  const double fat = 0.0040 * bump2(side - 0.036, t - 0.016, 0.0130, 0.0170);
  // From the wing of the nose to beside the corner of the mouth.
  const double fold_s = 0.0200 + 0.34 * (0.0260 - t);
  const double nasolabial = -0.0014 * bump((side - fold_s) / 0.0050) * bump((t - 0.012) / 0.0150);
  const double temple = -0.0050 * bump2(side - 0.086, t - 0.090, 0.0200, 0.0240);
  const double chin = 0.0070 * chin_ * bump2(s, t + 0.033, 0.0150, 0.0130);
  const double jaw = 0.0040 * jaw_width_ * bump2(side - 0.080, t + 0.022, 0.0240, 0.0200);
  return cheekbone + hollow + fat + nasolabial + temple + chin + jaw;
}

double HeadShape::relief(double s, double t) const {
  const float asymmetry = fractalNoise(static_cast<float>(s / 0.05), static_cast<float>(t / 0.05), 2, noise_seed_);
  return noseHeight(s, t) + eyeRelief(s, t) + lipRelief(s, t) + cheekRelief(s, t) + 0.0012 * asymmetry;
}

Eigen::Vector3d HeadShape::position(SkinPoint point) const {
  const Section section = sectionAt(point.t, landmarks_.bottom);
  const double angle = point.s / kMetresPerRadian;
  const double sine = std::sin(angle);
  const double cosine = std::cos(angle);
  // A face is flatter in front than an ellipse: |x|^p + |z|^p = 1 with p slightly above 2.
  constexpr double kExponent = 2.35;
  const double radius =
      std::pow(std::pow(std::abs(sine), kExponent) + std::pow(std::abs(cosine), kExponent), -1.0 / kExponent);
  const double half_width = section.half_width * width_ * mix(jaw_width_, 1.0, smoothStep(-0.06, 0.04, point.t));
  const Eigen::Vector3d base(half_width * radius * sine, section.y, section.depth * radius * cosine);
  // The tip of the nose hangs a little.
  const double height = relief(point.s, point.t);
  const double droop = -0.18 * noseHeight(point.s, point.t);
  return base + Eigen::Vector3d(height * sine, droop, height * cosine);
}

}  // namespace facezip::synth
