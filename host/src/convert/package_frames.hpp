// package_frames.hpp - the frames of a package's expressions as the textures of a capture: real numbers, neither
// rounded nor clamped, so that C difference textures reach them exactly.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "blend/band_blender.hpp"
#include "facezip/device.hpp"
#include "facezip/package.hpp"
#include "image/sample_bands.hpp"

namespace facezip::convert {

/// A map with beta of one expression 1, after the neutral: floats, 1 is full scale.
class PackageFrames final : public image::SampleSource {
 public:
  /// All are kept by reference. Throws InputError, DeviceError.
  PackageFrames(const Package& package, int map_index, const blend::WeightSets& weights, const Device& device);

  void readRows(int begin, int end, std::span<std::byte> out) override;

 private:
  const Package& package_;
  int map_index_;
  const blend::WeightSets& weights_;
  const Device& device_;
  std::unique_ptr<blend::BandBlender> blender_;  ///< anew in every pass: images are read from the top
  std::vector<float> beta_;
  std::vector<float> values_;
};

}  // namespace facezip::convert
