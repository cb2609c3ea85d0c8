// rig_json.hpp - rig.json: the shapes of a rig and how its expressions are posed (docs/rig.md).
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "facezip/rig.hpp"

namespace facezip::rig {

inline constexpr char kRigFile[] = "rig.json";
inline constexpr int kRigVersion = 1;
inline constexpr std::uintmax_t kMostRigBytes = 64u << 20;  ///< of rig.json
inline constexpr std::size_t kMostShapes = 4096;            ///< M: solving for weights takes M x M numbers
inline constexpr std::size_t kMostRigWeights = 1u << 20;    ///< N x M

/// The text of rig.json. millimetres_per_unit  of the meshes in shapes/
std::string rigJson(const RigReport& report, double millimetres_per_unit);

/// Reads and checks what openRig() returns, but for the directory; `text` is untrusted. file  path for messages
/// Throws InputError that names `file` and the field.
Rig parseRig(const std::string& text, const std::string& file);

/// Throws InputError where a rig would have more shapes, or more weights, than parseRig() takes.
void requireRigSize(std::size_t shapes, std::size_t expressions, const std::string& file);

}  // namespace facezip::rig
