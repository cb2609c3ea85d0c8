// shape_names_file.hpp - host/data/shape_names.json, compiled in.
#pragma once

#include <map>
#include <string_view>

namespace facezip::blend {

/// By file name.
const std::map<std::string_view, std::string_view>& embeddedShapeNames();

}  // namespace facezip::blend
