#include "export/unity.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <nlohmann/json.hpp>
#include <set>

#include "blocks/block_format.hpp"
#include "export/export_files.hpp"
#include "export/hlsl_text.hpp"
#include "io/counts.hpp"
#include "io/staged_directory.hpp"

namespace facezip::exporting {
namespace {

std::set<std::string> allTextures(const Package& package, const std::vector<EngineMap>& maps) {
  std::set<std::string> names;
  for (const EngineMap& map : maps) {
    for (const std::string& name : mapTextures(package, map)) names.insert(name);
  }
  return names;
}

std::string call(const Package& package, const EngineMap& map) {
  return fmt::format("facezip_{}(uv, facezip_sampler_trilinear_clamp, {})", map.id,
                     fmt::join(mapTextures(package, map), ", "));
}

// Projects in gamma space shade with sRGB.
constexpr char kGammaSpace[] = R"(
#ifdef UNITY_COLORSPACE_GAMMA
float3 facezip_gamma(float3 c) { return lerp(1.055 * pow(c, 1.0 / 2.4) - 0.055, c * 12.92, step(c, 0.0031308)); }
#endif
)";

/// One line of facezip_surface(), or a few.
std::string surfaceLine(const Package& package, const EngineMap& map) {
  const std::string value = call(package, map);
  const char* colour = map.map.channels < 3 ? "rrr" : "rgb";
  switch (map.role) {
    case mesh::MapRole::kAlbedo:
      if (map.map.colour_space == "linear") {
        return fmt::format(
            "  surface.albedo = saturate({}.{});\n#ifdef UNITY_COLORSPACE_GAMMA\n"
            "  surface.albedo = facezip_gamma(surface.albedo);\n#endif\n",
            value, colour);
      }
      return fmt::format(
          "  surface.albedo = {0}.{1};\n#ifdef UNITY_COLORSPACE_GAMMA\n  surface.albedo = saturate(surface.albedo);\n"
          "#else\n  surface.albedo = facezip_linear(surface.albedo);\n#endif\n",
          value, colour);
    case mesh::MapRole::kNormal:
      return fmt::format("  surface.normal = facezip_unit({}.rgb);\n", value);
    case mesh::MapRole::kRoughness:
      return fmt::format("  surface.roughness = saturate({}.r);\n", value);
    case mesh::MapRole::kOcclusion:
      return fmt::format("  surface.occlusion = saturate({}.r);\n", value);
    case mesh::MapRole::kOther:
      break;
  }
  return "";
}

std::string hlslFile(const Package& package, const std::vector<EngineMap>& maps) {
  std::string text =
      "// FaceZip.hlsl - written by facezip export: the blend of one face. UVs as meshes have them in Unity, v = 0 "
      "below.\n"
      "#ifndef FACEZIP_INCLUDED\n#define FACEZIP_INCLUDED\n";
  for (const std::string& name : allTextures(package, maps)) text += fmt::format("Texture2D<float4> {};\n", name);
  // Unity makes a sampler of the words in its name.
  text += "SamplerState facezip_sampler_trilinear_clamp;\n";
  text += fmt::format("float fz_beta[{}];  // weights of the expressions, by FaceZipDriver\n",
                      package.expressions().size());
  text += hlslFunctions(package, maps, Rows::kFromBottom, "static ", unityBlocks);
  text += kGammaSpace;
  text +=
      "\nstruct FaceZipSurface {\n  float3 albedo;\n  float3 normal;  // tangent space\n  float roughness;\n  float "
      "occlusion;\n};\n\n"
      "FaceZipSurface facezip_surface(float2 mesh_uv) {\n  float2 uv = float2(mesh_uv.x, 1.0 - mesh_uv.y);\n"
      "  FaceZipSurface surface;\n  surface.albedo = float3(0.5, 0.5, 0.5);\n  surface.normal = float3(0.0, 0.0, "
      "1.0);\n"
      "  surface.roughness = 0.55;  // of skin, roughly\n  surface.occlusion = 1.0;\n";
  for (const EngineMap& map : maps) text += surfaceLine(package, map);
  text +=
      "  return surface;\n}\n\n// For Custom Function nodes of Shader Graph, by this file: surface, and any map as it "
      "is stored.\n"
      "void FaceZip_float(float2 UV, out float3 Albedo, out float3 Normal, out float Smoothness) {\n"
      "  FaceZipSurface surface = facezip_surface(UV);\n  Albedo = surface.albedo;\n  Normal = surface.normal;\n"
      "  Smoothness = 1.0 - surface.roughness;\n}\n";
  for (const EngineMap& map : maps) {
    text += fmt::format(
        "void FaceZip_{}_float(float2 UV, out float4 Value) {{\n  float2 uv = float2(UV.x, 1.0 - UV.y);\n"
        "  Value = {};\n}}\n",
        map.id, call(package, map));
  }
  return text + "#endif\n";
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  text.replace(text.find(what), what.size(), by);
  return text;
}

/// ShaderLab's strings have no escapes, and end where their line does.
std::string plainName(const std::string& name) {
  std::string plain;
  for (const char c : name) {
    const bool odd = c == '"' || c == '\\' || c == '/' || static_cast<unsigned char>(c) < 0x20 || c == 0x7f;
    plain += odd ? ' ' : c;
  }
  return plain.empty() ? "face" : plain;
}

}  // namespace

std::optional<BlockFormat> unityBlocks(const PackageMap& map, int texture) {
  const std::optional<BlockFormat> format = texture < 0 ? map.neutral_format : map.differences[toSize(texture)].format;
  if (!format) return std::nullopt;
  const blocks::BlockFormatInfo& info = blocks::infoOf(*format);
  if (blocks::isAstc(*format)) return info.block_width == info.block_height ? format : std::nullopt;
  return map.width % 4 == 0 && map.height % 4 == 0 ? format : std::nullopt;
}

void writeUnity(const Package& package, const std::filesystem::path& folder, Progress& progress) {
  const std::vector<EngineMap> maps = engineMaps(package);
  requireMaps(package, maps);
  writePlainTextures(package, maps, folder, progress, unityBlocks);
  io::writeTextFile(folder / "FaceZip.hlsl", hlslFile(package, maps));
  std::string properties;
  for (const std::string& name : allTextures(package, maps)) {
    properties += fmt::format("    [NoScaleOffset] {0} (\"{0}\", 2D) = \"gray\" {{}}\n", name);
  }
  std::string shader(embeddedExportFiles().at("FaceZip.shader"));
  shader = replaced(shader, "@NAME@", plainName(package.name()));
  io::writeTextFile(folder / "FaceZip.shader", replaced(shader, "    @PROPERTIES@\n", properties));
  // What FaceZipDriver reads.
  const nlohmann::json face = {{"expressions", package.expressions()}};
  io::writeTextFile(folder / "FaceZip.json", face.dump(2) + "\n");
}

}  // namespace facezip::exporting
