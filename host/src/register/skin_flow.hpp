// skin_flow.hpp - rounds of optical flow: an expression's mesh drawn along its scan until its texture lies on the
// neutral's.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "device/device_context.hpp"
#include "facezip/geometry/skin_registration.hpp"
#include "facezip/progress.hpp"
#include "flow/texture_flow.hpp"
#include "raster/uv_raster.hpp"
#include "register/scan_alignment.hpp"
#include "register/texture_baking.hpp"

namespace facezip::registration {

/// What a scan shows at the layout's texels, as flow needs it.
struct SkinPicture {
  std::vector<SeenTexel> seen;      ///< [side][side], -1 beyond the triangles that the neutral's scan shows
  std::vector<float> grey;          ///< [side][side], 0..1
  std::vector<std::uint8_t> known;  ///< [side][side]
};

/// How far a texture lies from the neutral's, in texels of the picture that flow is taken of.
struct FlowLength {
  double mean = 0.0;
  double percentile_95 = 0.0;
  double trusted = 0.0;  ///< share of the texels whose flow comes back to where it began
};

struct FlowRounds {
  Eigen::MatrixX3d mesh;  ///< where the scan is
  int rounds = 0;
  FlowLength before, after;
};

/// The neutral's picture, and all that rounds of every expression share.
class SkinFlow {
 public:
  /// surface  of the subject
  /// layout   the template's triangles and UVs; is referred to, and has to stay
  /// neutral  the neutral's scan; `mesh` the subject's mesh on it
  /// Throws InputError (an image), DeviceError, SolverError, Cancelled.
  SkinFlow(const geometry::BentSurface& surface, const geometry::TriangleMesh& layout, const PlacedScan& neutral,
           const Eigen::MatrixX3d& mesh, device::DeviceContext& context, Progress& progress);

  /// Texels of the pictures' side.
  int side() const { return raster_.width(); }

  /// Draws the expression's mesh along its scan, at the most `kMostRounds` times, until 95 % of the texels flow by less
  /// than half of one.
  /// posed  the subject's shapes, fitted to the scan; mesh  bent onto it
  /// Throws InputError (an image), DeviceError, Cancelled, Error.
  FlowRounds draw(const Eigen::MatrixX3d& posed, const Eigen::MatrixX3d& mesh, const PlacedScan& placed) const;

 private:
  static constexpr int kMostRounds = 3;
  SkinPicture pictureOf(const Eigen::MatrixX3d& mesh, const PlacedScan& placed, ScanTextures& textures) const;
  flow::GreyPicture greyOf(const SkinPicture& picture) const;

  const geometry::TriangleMesh& layout_;
  device::DeviceContext& context_;
  Progress& progress_;
  raster::UvRaster raster_;
  std::vector<raster::TexelSample> texels_;
  geometry::SkinRegistration registration_;
  SkinPicture neutral_;
};

}  // namespace facezip::registration
