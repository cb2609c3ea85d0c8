// godot_shader.hpp - docs/blend.md in Godot 3's shading language.
#pragma once

#include <string>
#include <vector>

#include "export/engine_maps.hpp"

namespace facezip::exporting {

/// A shader of type spatial: `vec4 ID_value(vec2 uv)` of every map, and fragment() with those that have a role.
std::string godotShader(const Package& package, const std::vector<EngineMap>& maps);

}  // namespace facezip::exporting
