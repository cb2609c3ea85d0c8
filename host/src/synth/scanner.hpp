// scanner.hpp - what a capture stage adds to the truth: misalignment, drift of exposure, sensor noise.
#pragma once

#include <array>
#include <cstdint>

namespace facezip::synth {

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
  bool still_;
};

}  // namespace facezip::synth
