// rig_json.hpp - rig.json: the shapes of a rig and how its expressions are posed (docs/rig.md).
#pragma once

#include <string>

#include "facezip/rig.hpp"

namespace facezip::rig {

inline constexpr char kRigFile[] = "rig.json";
inline constexpr int kRigVersion = 1;

/// The text of rig.json. millimetres_per_unit  of the meshes in shapes/
std::string rigJson(const RigReport& report, double millimetres_per_unit);

}  // namespace facezip::rig
