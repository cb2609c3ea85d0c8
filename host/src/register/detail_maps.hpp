// detail_maps.hpp - what of a scan's shape the registered mesh is too coarse for, as textures.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "facezip/geometry/mesh.hpp"
#include "facezip/geometry/scan_surface.hpp"
#include "facezip/progress.hpp"
#include "raster/uv_raster.hpp"

namespace facezip::registration {

/// Of the texels that the scan shows; the others are filled smoothly from around them.
struct DetailMaps {
  int side = 0;
  /// [side][side][3], of length 1: the scan's normal in the frame of the mesh, x along u, y along v (up), z outwards
  std::vector<float> normals;
  std::vector<float> heights;  ///< [side][side]: millimetres of the scan above the mesh, along the mesh's normal
};

/// positions  of the registered mesh, where the scan is. Normals of mesh and scan are those of their vertices, between
/// them linear.
DetailMaps bakeDetail(const raster::UvRaster& raster, const geometry::TriangleMesh& mesh,
                      const Eigen::MatrixX3d& positions, const Eigen::MatrixX3i& scan_triangles,
                      const geometry::ScanSurface& scan, Progress& progress);

}  // namespace facezip::registration
