#include "export/unreal.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "export/hlsl_text.hpp"
#include "io/staged_directory.hpp"

namespace facezip::exporting {
namespace {

/// A struct, since the code of a Custom node stands inside a function: its methods are the only functions there.
std::string blendStruct(const Package& package, const std::vector<EngineMap>& maps) {
  return fmt::format(
      "// FaceZip.ush - written by facezip export: the blend of one face, for Custom nodes of materials.\n"
      "struct FaceZipBlend {{\nfloat fz_beta[{}];  // weights of the expressions\n{}}};\n",
      package.expressions().size(), hlslFunctions(package, maps, Rows::kFromTop, "", noBlocks));
}

/// The end of a Custom node's code, behind the struct. Inputs: uv, textures by name, beta_0 to beta_N-1.
std::string nodeCode(const Package& package, const EngineMap& map) {
  std::string text = "FaceZipBlend face;\n";
  for (std::size_t n = 0; n < package.expressions().size(); ++n) {
    text += fmt::format("face.fz_beta[{0}] = beta_{0};\n", n);
  }
  text += fmt::format("float4 value = face.facezip_{0}(uv, {0}_neutralSampler", map.id);
  for (const std::string& name : mapTextures(package, map)) text += ", " + name;
  text += ");\n";
  const char* colour = map.map.channels < 3 ? "rrr" : "rgb";
  switch (map.role) {
    case mesh::MapRole::kAlbedo:
      if (map.map.colour_space == "linear") return text + fmt::format("return saturate(value.{});\n", colour);
      return text + fmt::format("return face.facezip_linear(value.{});\n", colour);
    case mesh::MapRole::kNormal:  // whose y runs down here
      return text + "return face.facezip_unit(value.rgb) * float3(1.0, -1.0, 1.0);\n";
    case mesh::MapRole::kRoughness:
    case mesh::MapRole::kOcclusion:
      return text + "return saturate(value.r);\n";
    case mesh::MapRole::kOther:
      break;
  }
  return text + "return value;\n";
}

/// How Unreal, whose importers take no blocks, is to code a texture again that was in blocks; none: as it is. It makes
/// ASTC of both where platforms have no BC.
std::optional<std::string> compressionOf(const std::optional<BlockFormat>& format) {
  if (!format) return std::nullopt;
  return *format == BlockFormat::kBc1 ? "TC_DEFAULT" : "TC_BC7";
}

nlohmann::json compressions(const std::vector<EngineMap>& maps) {
  nlohmann::json all = nlohmann::json::object();
  for (const EngineMap& map : maps) {
    const auto add = [&](const std::string& name, const std::optional<BlockFormat>& format) {
      if (const auto compression = compressionOf(format)) all[map.id + name] = *compression;
    };
    add("_neutral", map.map.neutral_format);
    for (std::size_t i = 0; i < map.map.differences.size(); ++i) {
      add(fmt::format("_difference_{}", i), map.map.differences[i].format);
    }
  }
  return all;
}

/// Property of the material that a role goes to, and how many floats its node gives.
std::pair<const char*, int> materialProperty(mesh::MapRole role) {
  switch (role) {
    case mesh::MapRole::kAlbedo:
      return {"MP_BASE_COLOR", 3};
    case mesh::MapRole::kNormal:
      return {"MP_NORMAL", 3};
    case mesh::MapRole::kRoughness:
      return {"MP_ROUGHNESS", 1};
    case mesh::MapRole::kOcclusion:
      return {"MP_AMBIENT_OCCLUSION", 1};
    case mesh::MapRole::kOther:
      break;
  }
  return {"", 4};
}

}  // namespace

void writeUnreal(const Package& package, const std::filesystem::path& folder, Progress& progress) {
  const std::vector<EngineMap> maps = engineMaps(package);
  requireMaps(package, maps);
  writePlainTextures(package, maps, folder, progress, noBlocks);
  io::writeTextFile(folder / "FaceZip.ush", blendStruct(package, maps));
  // What facezip_unreal.py reads.
  nlohmann::json face = {{"name", package.name()},
                         {"expressions", package.expressions()},
                         {"nodes", nlohmann::json::array()},
                         {"compression", compressions(maps)}};
  for (const EngineMap& map : maps) {
    const std::string file = "node_" + map.id + ".hlsl";
    io::writeTextFile(folder / file, nodeCode(package, map));
    const auto [property, floats] = materialProperty(map.role);
    face["nodes"].push_back({{"map", map.id},
                             {"code", file},
                             {"textures", mapTextures(package, map)},
                             {"property", property},
                             {"floats", floats}});
  }
  io::writeTextFile(folder / "FaceZip.json", face.dump(2) + "\n");
}

}  // namespace facezip::exporting
