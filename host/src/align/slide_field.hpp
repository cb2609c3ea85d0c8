// slide_field.hpp - how the texture of an expression has to slide in its layout.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "facezip/geometry/mesh.hpp"
#include "flow/texture_flow.hpp"

namespace facezip::align {

/// Texel x of the layout is to show what texel x + vector(x) of the texture does.
struct SlideField {
  int width = 0;
  int height = 0;
  std::vector<float> vectors;  ///< [height][width][2], x to the right, y down, in texels

  /// The vector at a place of the unit square, u to the right, v up.
  Eigen::RowVector2d at(double u, double v) const;
};

SlideField stillField(int width, int height);

/// Which part of the layout the texels show, -1 for none; a gutter belongs to the part that it surrounds.
struct LayoutTexels {
  std::vector<int> island;              ///< [height][width]
  std::vector<std::uint8_t> region;     ///< [height][width], 1: of the region
  std::vector<std::uint8_t> elsewhere;  ///< [height][width], 1: of the mesh, not the region
};
LayoutTexels texelsOf(const geometry::TriangleMesh& mesh, std::span<const int> region, int width, int height);

/// A field and a flow that was found after it, in one: neither texture nor flow is resampled twice. Where flow is not
/// believed the field follows what is around; beyond the region nothing slides; nothing leaves its island.
SlideField composed(const SlideField& field, const flow::TextureFlow& flow, const LayoutTexels& texels);

/// Places in a texture of any size, for rows [begin, end) of it: x, y of each texel, centres at integers.
std::vector<float> placesOf(const SlideField& field, int begin, int end, int width, int height);

}  // namespace facezip::align
