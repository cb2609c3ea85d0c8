// package_decoder.hpp - the values that a package decodes to, band by band, as every measure of its errors takes them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "blend/band_blender.hpp"
#include "facezip/package.hpp"

namespace facezip::evaluate {

class PackageDecoder {
 public:
  /// Keeps `package` and `device` by reference. Throws InputError, DeviceError.
  PackageDecoder(const Package& package, const Device& device);

  const Package& package() const { return package_; }
  /// Bytes of the weights that stay on the device.
  std::uint64_t residentBytes() const;

  /// Opens a map; the methods below are about it. Throws InputError, DeviceError.
  void openMap(int map_index);
  /// Loads rows of the open map, as blend::BandBlender::loadRows().
  void loadRows(int begin, int end);
  /// Blends the loaded rows (Eq. 8): values in units of 1/255, interleaved.
  /// beta  N finite weights; out  rows x width x channels
  void decode(std::span<const float> beta, std::span<float> out);
  /// Decodes one expression: beta of it 1, of all others 0.
  void decodeExpression(int expression, std::span<float> out);

  /// From now on expression e of decode() and decodeExpression() stands for these weights of the package's expressions.
  /// weights  of each, as many values as the package has expressions; empty: the package's own
  void setExpressions(std::vector<std::vector<float>> weights);

 private:
  const Package& package_;
  const Device& device_;
  blend::WeightSets weights_;
  std::unique_ptr<blend::BandBlender> blender_;
  std::vector<float> beta_;
  std::vector<std::vector<float>> expressions_;  ///< empty: those of the package
};

}  // namespace facezip::evaluate
