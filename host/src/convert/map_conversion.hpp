// map_conversion.hpp - the maps of a package that share weights, fitted to blocks anew: what compress/block_stage.hpp
// does of a capture, of the package's own frames.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "bands/map_set.hpp"
#include "blend/band_blender.hpp"
#include "codes/coded_neutral.hpp"
#include "codes/map_codes.hpp"
#include "compress/memory_plan.hpp"
#include "compress/package_form.hpp"
#include "device/run.hpp"
#include "facezip/capture.hpp"
#include "facezip/geometry/mesh.hpp"
#include "facezip/package.hpp"
#include "refine/grid_weights.hpp"

namespace facezip::convert {

/// What all sets of weights of a package are converted with. References outlive the conversion.
struct Conversion {
  const Package& package;
  const Device& device;
  compress::TextureFormats formats;
  bool refits_weights = true;  ///< where maps in blocks alone use them
  const std::optional<geometry::TriangleMesh>& mesh;
  const blend::WeightSets& weights;  ///< of the package, on the device
  const device::Run& run;
};

/// The maps of 8 bits that use one set of weights. Stays where it is: its parts refer to each other.
struct ConvertedSet {
  compress::WeightSpace space;
  compress::EncodedWeights weights;  ///< as they are written
  std::vector<int> indices;          ///< of the maps in the package
  std::vector<CaptureMap> sources;   ///< names of the maps, for messages
  compress::MapSet maps;             ///< whose textures are the package's frames
  std::vector<compress::GridMap> group;
  std::vector<std::uint8_t> cells;  ///< 1 if a covered texel of any map lies in it
  double energy = 0.0;
  std::vector<compress::CodedNeutral> neutrals;
  std::vector<compress::MapCodes> codes;
  int band_rows = 0;

  std::uint64_t neutralBytes() const;
};

/// Fits the maps of `set`. kept_bytes  of what was converted before and is still held. Throws InputError, DeviceError,
/// Cancelled.
std::unique_ptr<ConvertedSet> convertSet(const Conversion& conversion, int set, std::uint64_t kept_bytes);

/// The weights of a set as a package holds them. Throws InputError.
compress::EncodedWeights readWeights(const Package& package, int set);

/// The grid of a set.
compress::WeightSpace spaceOf(const Package& package, int set);

/// Whether blocks can hold a map.
inline bool fitsBlocks(const PackageMap& map) { return map.sample_type == SampleType::kUint8; }

}  // namespace facezip::convert
