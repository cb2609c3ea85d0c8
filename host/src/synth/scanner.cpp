#include "synth/scanner.hpp"

#include <algorithm>

#include "synth/noise.hpp"

namespace facezip::synth {
namespace {

constexpr float kNoiseSigma255 = 0.8f;
// Gradient noise has an rms of about 0.35; two components of this amplitude have a length of 0.4 rms.
constexpr float kShiftAmplitude = 0.81f;
constexpr float kShiftsAcross = 6.0f;  // patches of the image that drift together
constexpr float kGainsAcross = 2.5f;

}  // namespace

Scanner::Scanner(std::uint64_t take, Subject subject)
    : take_(deriveSeed(take, "scan")), still_(subject == Subject::kNeutral) {}

std::array<float, 2> Scanner::misalignment(float u, float v) const {
  if (still_) return {0.0f, 0.0f};
  return {kShiftAmplitude * gradientNoise(kShiftsAcross * u, kShiftsAcross * v, take_ + 1),
          kShiftAmplitude * gradientNoise(kShiftsAcross * u, kShiftsAcross * v, take_ + 2)};
}

std::array<float, 3> Scanner::gain(float u, float v) const {
  std::array<float, 3> gains = {1.0f, 1.0f, 1.0f};
  if (still_) return gains;
  const float shared = gradientNoise(kGainsAcross * u, kGainsAcross * v, take_ + 3);
  for (std::size_t c = 0; c < 3; ++c) {
    const float own = gradientNoise(kGainsAcross * u, kGainsAcross * v, take_ + 4 + c);
    gains[c] += 0.01f * std::clamp(0.8f * shared + 0.4f * own, -1.0f, 1.0f);
  }
  return gains;
}

float Scanner::noise(int x, int y, int channel) const {
  const std::uint64_t place = (static_cast<std::uint64_t>(y) << 32) ^ static_cast<std::uint64_t>(4 * x + channel);
  return kNoiseSigma255 * approximateGaussian(mixBits(place ^ take_));
}

}  // namespace facezip::synth
