// texture_baking.hpp - a scan's texture in the layout of the mesh that was registered to it.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "device/device_context.hpp"
#include "facezip/geometry/scan_surface.hpp"
#include "facezip/progress.hpp"
#include "image/image_file.hpp"
#include "raster/uv_raster.hpp"
#include "register/resample.hpp"
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

/// A scan's textures on the device, averaged down to about what the layout can hold; or the colours of its vertices,
/// linear between them.
class ScanTextures {
 public:
  /// positions  of the registered mesh, or near it
  /// side       of the layout in texels
  /// Throws InputError (an image, textures that differ in channels or type), DeviceError.
  ScanTextures(const geometry::TriangleMesh& mesh, const Eigen::MatrixX3d& positions, int side, const Scan& scan,
               const geometry::ScanSurface& surface, device::DeviceContext& context);

  int channels() const { return sources_.empty() ? 3 : sources_.front().sampler.shape().channels; }
  image::SampleType type() const {
    return sources_.empty() ? image::SampleType::kUint8 : sources_.front().sampler.shape().type;
  }
  /// samples  channels() a texel, 1 at full scale; those of texels without a triangle stay as they are
  void sample(std::span<const SeenTexel> seen, std::span<float> samples);

 private:
  /// The texture of a material.
  struct Source {
    int material;
    double columns, rows;  ///< of the whole texture, in averaged texels
    TextureSampler sampler;
  };
  std::vector<float> placesOf(std::span<const SeenTexel> seen, const Source& source) const;
  void sampleColours(std::span<const SeenTexel> seen, std::span<float> samples) const;

  const Scan& scan_;
  std::vector<Source> sources_;
};

/// The side at which a layout holds all that the scan's textures do: texels of both are of one size on the skin. Of
/// coloured vertices, each is a texel.
double layoutSideOf(const geometry::TriangleMesh& mesh, const Eigen::MatrixX3d& positions, const Scan& scan,
                    const geometry::ScanSurface& surface);

/// The scan's textures in the layout. Throws DeviceError, Cancelled.
BakedTexture bakeTexture(const raster::UvRaster& raster, const geometry::TriangleMesh& mesh,
                         const Eigen::MatrixX3d& positions, const geometry::ScanSurface& surface,
                         ScanTextures& textures, Progress& progress);

}  // namespace facezip::registration
