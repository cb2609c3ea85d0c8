// part_looks.hpp - what a part of a head is by its name, and how such parts look where nobody says it.
#pragma once

#include <string>
#include <vector>

#include "facezip/package.hpp"

namespace facezip::rig {

/// What places a part on the subject.
enum class PartPlace {
  kAlone,  ///< each connected piece for itself
  kEye,    ///< pieces around one centre together, and rigid: ball and cornea
  kMouth,  ///< all pieces of such parts together, and rigid: teeth stay in their gums
  kSkin,   ///< it bends with the skin that it lies on
};

/// What is painted where the template has no texture.
enum class PartPaint { kNone, kIris, kHairs, kShade };

struct PartLook {
  PackageMaterial material;  ///< without name and texture
  PartPlace place = PartPlace::kAlone;
  PartPaint paint = PartPaint::kNone;
};

/// By the table of host/data/part_looks.json, whose words are looked for as those of maps are (mesh/map_roles.hpp).
PartLook lookOf(const std::string& name);

/// Names of the parts of a template that has none, if its topology is known by its number of vertices. Else none.
struct KnownPart {
  std::string name;
  int first = 0;  ///< vertices [first, last]
  int last = 0;
};
std::vector<KnownPart> knownParts(int vertices);

}  // namespace facezip::rig
