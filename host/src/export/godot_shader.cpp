#include "export/godot_shader.hpp"

#include <fmt/format.h>

namespace facezip::exporting {
namespace {

// The language has neither includes nor arrays of uniforms: numbers stand where they are used, and the weights come as
// a texture of the expressions in use, (layer, weight) each.
constexpr char kHead[] = R"(shader_type spatial;
// Written by facezip export. Blends the textures of a face by the weights of its expressions; facezip_face.gd sets them.
// Samples are taken as they are stored: import without sRGB (the .import files say so).

uniform sampler2D facezip_active;  // facezip_count texels: layer of the weight maps, weight
uniform int facezip_count;
)";

/// Steps 1 and 2 of docs/blend.md in one. Tiles have a border of one cell that repeats their edge.
std::string weightFunction(const PackageWeights& weights, int set, std::size_t file) {
  const int channels = std::min(4, static_cast<int>(weights.scale.size()) - 4 * static_cast<int>(file));
  return fmt::format(R"(
uniform sampler2DArray weights_{0}_{1};

// Cell centres are the integers. Not by texelFetch: Godot stores the codes as sRGB, and tells samplers alone to leave them.
vec4 blended_weights_{0}_{1}(vec2 cell) {{
  vec2 texel = vec2({5}, {6});
  vec2 at = (floor(cell) + vec2(1.5)) * texel;
  vec2 f = fract(cell);
  vec4 codes = vec4(0.0);
  float sum = 0.0;
  for (int k = 0; k < facezip_count; k++) {{
    vec2 entry = texelFetch(facezip_active, ivec2(k, 0), 0).rg;
    vec4 a = textureLod(weights_{0}_{1}, vec3(at, entry.r), 0.0);
    vec4 b = textureLod(weights_{0}_{1}, vec3(at + vec2(texel.x, 0.0), entry.r), 0.0);
    vec4 c = textureLod(weights_{0}_{1}, vec3(at + vec2(0.0, texel.y), entry.r), 0.0);
    vec4 d = textureLod(weights_{0}_{1}, vec3(at + texel, entry.r), 0.0);
    codes += mix(mix(a, b, f.x), mix(c, d, f.x), f.y) * entry.g;
    sum += entry.g;
  }}
  return {2} * {3} + {4} * sum;
}}
)",
                     set, file, swizzled("vec4", "codes", channels),
                     literal("vec4",
                             [&] {
                               std::array<double, 4> scale = fourOf(weights.scale, file);
                               for (double& s : scale) s *= 255.0;
                               return scale;
                             }()),
                     literal("vec4", fourOf(weights.offset, file)),
                     literal(1.0 / (weights.tile_width + 2 * weights.border)),
                     literal(1.0 / (weights.tile_height + 2 * weights.border)));
}

/// Step 3.
std::string valueFunction(const EngineMap& map, const PackageWeights& weights) {
  const double s = map.map.weight_scale;
  std::string text = fmt::format(
      "\nuniform sampler2D {0}_neutral;\nuniform sampler2DArray {0}_differences;\n\n// T, as it is stored.\n"
      "vec4 {0}_value(vec2 uv) {{\n"
      "  vec2 cell = clamp(uv * vec2({1}, {2}) - vec2(0.5), vec2(0.0), vec2({3}, {4}));\n",
      map.id, literal(map.map.width / s), literal(map.map.height / s), literal(weights.tile_width - 1.0),
      literal(weights.tile_height - 1.0));
  for (std::size_t f = 0; f < weights.files.size(); ++f) {
    text += fmt::format("  vec4 w{1} = blended_weights_{0}_{1}(cell);\n", map.map.weight_set, f);
  }
  text += fmt::format("  vec4 value = texture({}_neutral, uv);\n", map.id);
  if (map.map.channels < 3) text += fmt::format("  value = {};\n", swizzled("vec4", "value", map.map.channels));
  for (std::size_t i = 0; i < map.differences.size(); ++i) {
    const std::string sample =
        fmt::format("texture({}_differences, vec3(uv, {}))", map.id, literal(static_cast<double>(i)));
    text += fmt::format("  value += ({} - {}) * {} * w{}.{};\n", swizzled("vec4", sample, map.map.channels),
                        literal("vec4", map.differences[i].zero), literal("vec4", map.differences[i].scale), i / 4,
                        "xyzw"[i % 4]);
  }
  return text + "  return value;\n}\n";
}

std::string fragmentLines(const EngineMap& map) {
  switch (map.role) {
    case mesh::MapRole::kAlbedo: {
      const char* gray = map.map.channels < 3 ? "rrr" : "rgb";
      std::string text = fmt::format("  vec3 albedo = clamp({}_value(UV).{}, vec3(0.0), vec3(1.0));\n", map.id, gray);
      if (map.map.colour_space == "linear") return text + "  ALBEDO = albedo;\n";
      return text +
             "  // sRGB to linear light.\n"
             "  ALBEDO = mix(pow((albedo + vec3(0.055)) / 1.055, vec3(2.4)), albedo / 12.92, "
             "step(albedo, vec3(0.04045)));\n";
    }
    case mesh::MapRole::kNormal:
      return fmt::format("  NORMALMAP = clamp({}_value(UV).rgb, vec3(0.0), vec3(1.0));\n", map.id);
    case mesh::MapRole::kRoughness:
      return fmt::format("  roughness = clamp({}_value(UV).r, 0.05, 1.0);\n", map.id);
    case mesh::MapRole::kOcclusion:
      return fmt::format("  AO = clamp({}_value(UV).r, 0.0, 1.0);\n", map.id);
    case mesh::MapRole::kOther:
      break;
  }
  return "";
}

}  // namespace

std::string godotShader(const Package& package, const std::vector<EngineMap>& maps) {
  std::string text = kHead;
  for (const int set : usedSets(maps)) {
    const PackageWeights& weights = package.weightSets()[static_cast<std::size_t>(set)];
    for (std::size_t f = 0; f < weights.files.size(); ++f) text += weightFunction(weights, set, f);
  }
  std::string fragment = "\nvoid fragment() {\n  float roughness = 0.55;  // of skin, roughly\n";
  for (const EngineMap& map : maps) {
    text += valueFunction(map, package.weightSets()[static_cast<std::size_t>(map.map.weight_set)]);
    fragment += fragmentLines(map);
  }
  return text + fragment + "  ROUGHNESS = roughness;\n  SPECULAR = 0.35;\n}\n";
}

}  // namespace facezip::exporting
