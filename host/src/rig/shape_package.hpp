// shape_package.hpp - a package of a face whose shapes are known beforehand: no captured expression stands behind them,
// the shapes are its expressions.
#pragma once

#include <filesystem>
#include <vector>

#include "facezip/capture.hpp"
#include "facezip/compress.hpp"
#include "facezip/device.hpp"
#include "facezip/geometry/example_rig.hpp"
#include "facezip/progress.hpp"
#include "facezip/rig.hpp"
#include "rig/rig_meshes.hpp"
#include "rig/rig_template.hpp"

namespace facezip::rig {

/// A neutral and what it can do.
struct ShapedFace {
  RigTemplate rig_template;
  RigSubject subject;        ///< without expressions
  geometry::ExampleRig rig;  ///< shapes and transferred shapes alone; N = 0
};

/// Writes all of a rig's package into the staging folder `directory`: the compressed textures, shapes/NAME.obj,
/// rig.gltf and rig.json.
/// neutral   the subject's capture; of its maps only those of `textures` are packed
/// textures  maps with an image for each of the M shapes; the neutral's own image says that nothing changes
/// eyes      as assembleFace() takes it
/// report    gets what is known of the shapes
/// Throws as compressCapture() does.
void writeShapePackage(const Capture& neutral, const ShapedFace& face, const std::vector<CaptureMap>& textures,
                       const CompressOptions& options, const std::string& eyes, const std::filesystem::path& directory,
                       const Device& device, Progress& progress, RigReport& report);

}  // namespace facezip::rig
