// part_paint.hpp - textures for parts that come without: irises for eyeballs, hairs for lashes, shade for the skin's
// shadow on the eye. Painted by where a texel lies in space, so that any layout will do.
#pragma once

#include <Eigen/Core>
#include <string>

#include "facezip/geometry/mesh.hpp"
#include "rig/iris.hpp"
#include "rig/template_parts.hpp"

namespace facezip::rig {

/// Where parts lie in the template.
struct PartScene {
  const Eigen::MatrixX3d& positions;  ///< of the whole template
  Eigen::Index skin_vertices = 0;
  Eigen::Index skin_triangles = 0;
  const PartGroups& groups;
};

/// Paints what lookOf() says into the parts that have no texture; with `repaint` irises into all eyes.
/// mesh   the whole mesh: painted parts get UVs of their own in it, their layout stretched to the unit square
/// parts  get textures
void paintParts(const PartScene& scene, const Iris& iris, bool repaint, geometry::TriangleMesh& mesh,
                TemplateParts& parts);

}  // namespace facezip::rig
