// scanner.hpp - what a capture stage adds to the truth: misalignment, drift of exposure, sensor noise.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace facezip::synth {

/// A field over the image that is so smooth that 64 x 64 bilinear patches hold it: six lookups per texel and
/// expression are cheaper than six evaluations of noise.
class SmoothField {
 public:
  /// amplitude * gradientNoise() with `features` features along a side
  SmoothField(float amplitude, float features, std::uint64_t seed);
  float at(float u, float v) const;

 private:
  static constexpr int kPatches = 64;
  std::vector<float> knots_;  ///< (kPatches + 1)^2, row-major
};

/// Imperfections of the scan of one expression. The neutral is only noisy: the others are aligned to it.
class Scanner {
 public:
  enum class Subject { kNeutral, kExpression };

  /// take  seed of the scan
  Scanner(std::uint64_t take, Subject subject);

  /// Where the scan takes the texel from, as an offset in texels; u and v in [0, 1]. About 0.4 texel rms in length.
  std::array<float, 2> misalignment(float u, float v) const;

  /// Factor on the encoded value of a channel, within 1 % of 1, drifting over the image.
  std::array<float, 3> gain(float u, float v) const;

  /// White noise of one encoded sample in units of 1/255, sigma 0.8.
  float noise(int x, int y, int channel) const;

 private:
  std::uint64_t take_;
  std::vector<SmoothField> shifts_;  ///< x, y; empty for the neutral
  std::vector<SmoothField> gains_;   ///< R, G, B; empty for the neutral
};

}  // namespace facezip::synth
