// map_roles.hpp - which map is which part of a physical material, by its name, the same for every target and viewer.
#pragma once

#include <string>
#include <vector>

#include "facezip/package.hpp"

namespace facezip::mesh {

/// What a map is in a physical material; the first map of a role has it.
enum class MapRole { kAlbedo, kNormal, kRoughness, kOcclusion, kOther };

/// "albedo", "normal", ...; "" for kOther.
std::string roleName(MapRole role);

/// The role that a name asks for, by the table of host/data/map_roles.json, in its order. Names are taken apart at
/// capitals, digits and signs (`BaseColor`, `base_color`): a word of the table is one or several parts of the name in
/// a row, or stands anywhere in it where it has six letters or more. A role is not given where the name holds one of
/// the words that speak against it: a normal map for DirectX has its y down, a specular albedo is no albedo.
MapRole roleOf(const std::string& name);

/// Does a name hold one of the words, as roleOf() looks for them?
bool nameHolds(const std::string& name, const std::vector<std::string>& words);

/// Roles of the maps in their order; of maps of floats, which no target shows, kOther.
std::vector<MapRole> rolesOf(const std::vector<PackageMap>& maps);

/// A sentence for every map of 8 or 16 bits that has no role, or a role of which `shown` has none.
std::vector<std::string> notesOfRoles(const std::vector<PackageMap>& maps, const std::vector<MapRole>& shown);

}  // namespace facezip::mesh
