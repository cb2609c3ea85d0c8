// band_blender.hpp - blends one map of a package, band of rows by band of rows, so that images larger than memory pass.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "facezip/device.hpp"
#include "facezip/package.hpp"

namespace facezip::blend {

class WeightMaps;
/// The sets of weight maps of a package, on a device, in the order of Package::weightSets().
using WeightSets = std::vector<std::shared_ptr<WeightMaps>>;

/// Reads a band of the neutral and the difference textures from disk, then blends it with any number of weight vectors.
/// The same code as Blender: the same bits for every row.
class BandBlender {
 public:
  /// Opens the images of map `map_index`, which takes its own set of `weights` (loadWeightMaps, once for all maps).
  /// Throws InputError, DeviceError.
  BandBlender(const Package& package, int map_index, const WeightSets& weights, const Device& device);
  ~BandBlender();
  BandBlender(BandBlender&&) noexcept;

  /// Rows, a multiple of rowStep(), whose textures and frame of blend() take at most `bytes` on host and device
  /// together; values take 4 bytes a sample in place of the neutral's.
  int rowsWithin(std::size_t bytes) const;
  /// Bands begin at a multiple of this.
  static constexpr int rowStep() { return 8; }

  /// Loads rows [begin, end): begin a multiple of rowStep(), end too or the map's height. Bands in rising order read
  /// the files once. Throws InputError for damaged images, DeviceError.
  void loadRows(int begin, int end);

  /// Blends the loaded rows.
  /// beta  N finite weights, in the package's order
  /// out   (end - begin) x width x channels samples of the neutral's type, interleaved
  void blend(std::span<const float> beta, std::span<std::byte> out);

  /// Blends the loaded rows as a renderer sees them, before they are rounded to samples: T of docs/package_format.md in
  /// units of 1/255 of full scale. Not clamped: values may lie outside 0 to 255.
  /// beta  N finite weights, in the package's order
  /// out   (end - begin) x width x channels, interleaved
  void blendValues(std::span<const float> beta, std::span<float> out);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Reads every set of weight maps of `package` onto `device`. Throws InputError, DeviceError.
WeightSets loadWeightMaps(const Package& package, const Device& device);

}  // namespace facezip::blend
