// texel_masks.hpp - masks from the vertices of the region to the texels of a band and the cells of the weight grid.
#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "facezip/geometry/face_region.hpp"
#include "facezip/geometry/mask_weights.hpp"
#include "raster/texel_classes.hpp"
#include "raster/tiles.hpp"
#include "raster/uv_raster.hpp"

namespace facezip::raster {

/// Interpolates vertex masks linearly over triangles. Rows sum to one at the vertices, so they do at every texel: the
/// division by the sum over masks (FaceZip 3.1, "normalizing the solution in the UV space") is already done.
class TexelMasks {
 public:
  /// mesh    the mesh that the raster was made of
  /// region  its region; masks are rows of `masks`, one per region vertex. All three are kept by reference.
  TexelMasks(const geometry::TriangleMesh& mesh, const geometry::RegionMesh& region,
             const geometry::MaskWeights& masks);

  int maskCount() const { return masks_.mask_count; }

  enum class Texels { kCovered, kCoveredAndGutter };
  /// Cuts rows [begin, end) of the raster into tiles and gives each the masks that are above zero at one of its texels.
  /// Tiles without such texels are left out; masks are 0 at all others.
  TileMasks tiles(const UvRaster& raster, int begin, int end, Texels texels) const;

  /// Pairs of masks that are both above zero somewhere inside a triangle, rising by (k, l): of all others the products
  /// vanish at every texel.
  std::vector<MaskPair> overlappingPairs() const;

  /// A mask inside a triangle.
  struct Corners {
    int mask;
    std::array<float, 3> weights;

    float at(const TexelSample& sample) const {
      return sample.b0 * weights[0] + sample.b1 * weights[1] +
             std::max(0.0f, 1.0f - sample.b0 - sample.b1) * weights[2];
    }
  };

  /// Finds the masks of triangles, of one after the other: neighbouring texels mostly lie in the same.
  class Cursor {
   public:
    explicit Cursor(const TexelMasks& masks);
    /// Masks that are above zero at a corner of a triangle of the region, in no order. Valid until the next call.
    std::span<const Corners> at(int triangle) {
      if (triangle != triangle_) moveTo(triangle);
      return corners_;
    }

   private:
    void moveTo(int triangle);

    const TexelMasks& masks_;
    int triangle_ = -1;
    std::vector<Corners> corners_;
    std::vector<int> place_;  // of every mask in corners_; -1 where it is not there
  };

 private:
  void addTile(const std::vector<TexelSample>& samples, int width, int rows, TilePosition position, Cursor& cursor,
               std::vector<float>& scratch, bool fades, TileMasks& out) const;

  const geometry::TriangleMesh& mesh_;
  const geometry::RegionMesh& region_;
  const geometry::MaskWeights& masks_;
};

/// The tiles of rows [begin, end) that hold covered texels, with texel weights and no masks: what sums over the face
/// need.
TileMasks coverageTiles(const UvRaster& raster, int begin, int end);

/// The tiles of rows [begin, end) that hold covered, gutter or feather texels, each with one mask (index 0): 1 at those
/// texels, 0 elsewhere. Texel weights are 1 at the covered ones.
TileMasks activeTiles(const TexelClasses& classes, int begin, int end);

}  // namespace facezip::raster
