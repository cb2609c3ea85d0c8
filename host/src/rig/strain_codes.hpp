// strain_codes.hpp - the weight maps of a rig's shapes in a package of compress and stretch maps.
#pragma once

#include "bands/map_set.hpp"
#include "facezip/geometry/example_rig.hpp"
#include "facezip/geometry/mesh.hpp"
#include "facezip/package.hpp"
#include "rig/shape_codes.hpp"

namespace facezip::rig {

/// Influences of the shapes (Li et al. 2020, Eq. 10 and 11), normalised over the shapes (Eq. 12): the weights of Eq.
/// 14, where blendshapes stand in place of the expressions that the maps were made of. Those of the captured
/// expressions stay, in coarser codes where the shapes' shares need them; either add up to 1 in every cell. neutral the
/// subject's;  map  one that the set is used by. Throws InputError.
ShapeCodes strainShapes(const Package& package, int set, const geometry::TriangleMesh& neutral,
                        const geometry::ExampleRig& rig, const compress::GridMap& map);

}  // namespace facezip::rig
