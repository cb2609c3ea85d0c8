// map_roles_file.hpp - host/data/map_roles.json, compiled in.
#pragma once

#include <map>
#include <string_view>

namespace facezip::mesh {

/// By file name.
const std::map<std::string_view, std::string_view>& embeddedMapRoles();

}  // namespace facezip::mesh
