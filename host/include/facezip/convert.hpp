// convert.hpp - a finished package with its textures in other blocks, or as images again.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "facezip/block_format.hpp"
#include "facezip/device.hpp"
#include "facezip/memory.hpp"
#include "facezip/package.hpp"
#include "facezip/progress.hpp"

namespace facezip {

struct ConvertOptions {
  /// Of the maps of 8 bits, as CompressOptions has it; none: images.
  std::optional<BlockFormat> texture_format;
  /// Of their difference textures, where it is to be another.
  std::optional<BlockFormat> difference_format;
  std::uint64_t memory_bytes = kDefaultMemoryBytes;  ///< what the process may keep resident
};

/// What a conversion did.
struct ConvertReport {
  struct Map {
    std::string name;
    std::optional<BlockFormat> texture_format;     ///< as written; none: images
    std::optional<BlockFormat> difference_format;  ///< likewise
    std::uint64_t bytes_before = 0;                ///< of its textures at run time, without weights and mip levels
    std::uint64_t bytes_after = 0;
    /// Between the frames of both packages, as decoded from disk, before they are rounded: root mean square over all
    /// expressions, channels and the texels that the package's difference textures change. 0 of maps that were copied.
    double rmse = 0.0;
  };
  std::vector<Map> maps;
  std::uint64_t memory_before = 0;  ///< Package::bytesInMemory()
  std::uint64_t memory_after = 0;
  std::uint64_t disk_before = 0;  ///< Package::bytesOnDisk()
  std::uint64_t disk_after = 0;
  std::vector<std::pair<std::string, double>> seconds;  ///< wall time of each stage, in order
  std::string device;
};

/// Writes `package` with the textures of its maps of 8 bits in blocks. They are not coded as they are: the package's
/// own frames of every expression take the place of a capture, and neutral, difference textures and (of method
/// `refined`) weights are fitted to them as compressCapture() fits them (docs/method.md). Maps of more bits, and
/// weights that such maps share, are copied. As images, textures are what their blocks decode to, rounded to whole
/// codes. Mesh, masks, regions and what makes a rig are kept. output  a package of facezip there is replaced; appears
/// whole or not at all Throws InputError: a damaged package, a format that a map's channels do not fit, a package
/// without a map to convert, too little memory; OutputError: `output` is the package, lies in it or holds it;
/// DeviceError, Cancelled.
ConvertReport convertPackage(const Package& package, const std::filesystem::path& output, const ConvertOptions& options,
                             const Device& device, Progress& progress);

}  // namespace facezip
