#include "synth/scanner.hpp"

#include <algorithm>

#include "synth/noise.hpp"

namespace facezip::synth {
namespace {

constexpr float kNoiseSigma255 = 0.8f;
// Gradient noise has an rms of about 0.30; two components of this amplitude have a length of 0.4 rms.
constexpr float kShiftAmplitude = 0.93f;
constexpr float kShiftsAcross = 6.0f;  // patches of the image that drift together
constexpr float kGainsAcross = 2.5f;
constexpr float kGainAmplitude = 0.01f;  // the most that gradient noise can reach is 1

}  // namespace

SmoothField::SmoothField(float amplitude, float features, std::uint64_t seed) {
  for (int row = 0; row <= kPatches; ++row) {
    for (int column = 0; column <= kPatches; ++column) {
      const float scale = features / static_cast<float>(kPatches);
      knots_.push_back(amplitude *
                       gradientNoise(scale * static_cast<float>(column), scale * static_cast<float>(row), seed));
    }
  }
}

float SmoothField::at(float u, float v) const {
  const float x = std::clamp(u, 0.0f, 0.9999f) * kPatches;
  const float y = std::clamp(v, 0.0f, 0.9999f) * kPatches;
  const int column = static_cast<int>(x);
  const int row = static_cast<int>(y);
  const float* knots = knots_.data() + row * (kPatches + 1) + column;
  const float fx = x - static_cast<float>(column);
  const float fy = y - static_cast<float>(row);
  const float above = knots[0] + fx * (knots[1] - knots[0]);
  const float below = knots[kPatches + 1] + fx * (knots[kPatches + 2] - knots[kPatches + 1]);
  return above + fy * (below - above);
}

Scanner::Scanner(std::uint64_t take, Subject subject) : take_(deriveSeed(take, "scan")) {
  if (subject == Subject::kNeutral) return;
  for (std::uint64_t axis = 0; axis < 2; ++axis) shifts_.emplace_back(kShiftAmplitude, kShiftsAcross, take_ + 1 + axis);
  for (std::uint64_t channel = 0; channel < 3; ++channel)
    gains_.emplace_back(kGainAmplitude, kGainsAcross, take_ + 3 + channel);
}

std::array<float, 2> Scanner::misalignment(float u, float v) const {
  if (shifts_.empty()) return {0.0f, 0.0f};
  return {shifts_[0].at(u, v), shifts_[1].at(u, v)};
}

std::array<float, 3> Scanner::gain(float u, float v) const {
  if (gains_.empty()) return {1.0f, 1.0f, 1.0f};
  return {1.0f + gains_[0].at(u, v), 1.0f + gains_[1].at(u, v), 1.0f + gains_[2].at(u, v)};
}

float Scanner::noise(int x, int y, int channel) const {
  const std::uint64_t place = (static_cast<std::uint64_t>(y) << 32) ^ static_cast<std::uint64_t>(4 * x + channel);
  return kNoiseSigma255 * approximateGaussian(mixBits(place ^ take_));
}

}  // namespace facezip::synth
