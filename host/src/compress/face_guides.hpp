// face_guides.hpp - what a package keeps of the geometry for people: meshes, masks and regions with names.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <vector>

#include "face/face.hpp"
#include "facezip/package.hpp"
#include "image/image_file.hpp"
#include "raster/grid_masks.hpp"

namespace facezip::compress {

/// The masks as a package keeps them.
struct MaskGuides {
  PackageMasks masks;
  std::vector<PackageRegion> regions;
  image::Image picture;  ///< of masks.file
};

/// Averages the masks over cells until no side has more than 128 of them, and groups them by where their samples lie in
/// the bounding box of the region: its thirds from right to left (the subject's; +x) and from low to high (+y), so at
/// most nine regions, "upper left" to "lower right". A head that does not stand upright along y gets other names.
MaskGuides makeMaskGuides(const Face& face, const FaceMasks& masks, const raster::GridMasks& grid);

/// Writes mesh.glb into `directory`: the neutral, and as morph targets the expressions that have a mesh; all less
/// geometry::floatOrigin() of the neutral. In metres where the unit is known or can be guessed, else as it is in the
/// capture. expressions  N, #V by 3 or 0 rows, as readExpressionMeshes() gives them. Throws OutputError.
void writeFaceMesh(const Capture& capture, const Face& face, std::optional<geometry::LengthUnit> unit,
                   const std::vector<Eigen::MatrixX3f>& expressions, const std::filesystem::path& directory);

}  // namespace facezip::compress
