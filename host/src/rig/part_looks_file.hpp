// part_looks_file.hpp - host/data/part_looks.json, compiled in.
#pragma once

#include <map>
#include <string_view>

namespace facezip::rig {

/// By file name.
const std::map<std::string_view, std::string_view>& embeddedPartLooks();

}  // namespace facezip::rig
