// texture_baking.hpp - a scan's texture in the layout of the mesh that was registered to it.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "device/device_context.hpp"
#include "facezip/geometry/scan_surface.hpp"
#include "facezip/progress.hpp"
#include "image/image_file.hpp"
#include "raster/uv_raster.hpp"
#include "register/scan_files.hpp"

namespace facezip::registration {

/// A texture in the template's layout.
struct BakedTexture {
  int side = 0;
  int channels = 0;                                    ///< 1 or 3
  image::SampleType type = image::SampleType::kUint8;  ///< of the scan's texture
  std::vector<float> samples;  ///< [side][side][channels], 1 at full scale; 0 where nothing was seen
  /// [side][side]: 0 where the scan shows nothing; up to 255 where it lies close by and faces as the mesh does
  std::vector<std::uint8_t> confidence;
};

/// The surface of the mesh at a texel, as the scan shows it.
struct SeenTexel {
  std::int32_t triangle = -1;  ///< of the scan; -1: nothing seen
  float b0 = 0.0f, b1 = 0.0f;  ///< barycentric coordinates of its corners 0 and 1
  std::uint8_t confidence = 0;
};

/// For texels of rows [begin, end) the scan's point that is closest and faces as the mesh does.
/// positions  of the registered mesh, where the scan is
/// The scan's border counts as nothing seen: beyond it everything would show the same texels.
std::vector<SeenTexel> seenTexels(const raster::UvRaster& raster, const Eigen::MatrixX3i& triangles,
                                  const Eigen::MatrixX3d& positions, const geometry::ScanSurface& scan, int begin,
                                  int end);

/// Samples the scan's textures on the device. Textures finer than the layout are averaged down first.
/// Throws InputError (an image), DeviceError, Cancelled.
BakedTexture bakeTexture(const raster::UvRaster& raster, const geometry::TriangleMesh& mesh,
                         const Eigen::MatrixX3d& positions, const Scan& scan, const geometry::ScanSurface& surface,
                         device::DeviceContext& context, Progress& progress);

}  // namespace facezip::registration
