// subject.hpp - what every part of an evaluation is about.
#pragma once

#include <cstdint>
#include <vector>

#include "bands/map_set.hpp"
#include "evaluate/package_decoder.hpp"
#include "face/face.hpp"
#include "facezip/capture.hpp"
#include "facezip/compress.hpp"
#include "facezip/device.hpp"
#include "facezip/package.hpp"
#include "facezip/progress.hpp"

namespace facezip::evaluate {

struct Subject {
  Capture capture;           ///< with the package's maps, in its order
  CompressOptions recorded;  ///< what the package was made with, and the memory that is allowed
  const Device& device;
  Progress& progress;
  compress::Face face;
  /// Weights of the package's expressions that each of the capture's stands for; empty where they are the same.
  std::vector<std::vector<float>> as_packed;
  std::vector<std::vector<float>> as_rigged;  ///< the same by the shapes of a rig alone; empty without a rig

  int expressions() const { return static_cast<int>(capture.expressions.size()); }
};

/// The capture's maps that the package has, and how the package was made.
/// shapes  of a rig's package: the capture's expressions are single shapes of the rig
/// Throws InputError for a package of another capture.
Subject makeSubject(const Capture& capture, const Package& package, std::uint64_t memory_bytes, bool shapes,
                    const Device& device, Progress& progress);

/// Throws InputError if the map of the package has not the size, channels and type of the captured one.
void requireSameShape(const compress::OpenMap& map, const PackageMap& packed, const Package& package);

/// Opens the captured textures of all maps.
compress::MapSet openMaps(const Subject& subject);

/// Rows of a band in which each of the packages is decoded beside the captured textures.
/// beside_bytes  kept resident beside bands and packages
int bandRows(const Subject& subject, const compress::OpenMap& map, const std::vector<PackageDecoder*>& decoders,
             std::uint64_t beside_bytes);

}  // namespace facezip::evaluate
