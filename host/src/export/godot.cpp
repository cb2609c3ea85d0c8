#include "export/godot.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "export/engine_maps.hpp"
#include "export/godot_shader.hpp"
#include "io/staged_directory.hpp"

namespace facezip::exporting {
namespace fs = std::filesystem;
namespace {

/// A string of a resource file.
std::string quote(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c;
  }
  return quoted + '"';
}

/// How Godot's editor imports a texture; what is not said here has its defaults. Samples stay as they are: no sRGB, no
/// compression, and none that is switched on when a texture is seen in 3D.
void writeTextureImport(const fs::path& png) {
  io::writeTextFile(png.string() + ".import",
                    "[remap]\n\nimporter=\"texture\"\ntype=\"StreamTexture\"\n\n[params]\n\n"
                    "compress/mode=0\nflags/repeat=0\nflags/filter=true\nflags/mipmaps=true\nflags/srgb=0\n"
                    "process/fix_alpha_border=false\ndetect_3d=false\n");
}

enum class Filter { kMipmaps, kNone };

void writeArrayImport(const fs::path& png, int columns, int rows, Filter filter) {
  const bool filtered = filter == Filter::kMipmaps;
  io::writeTextFile(png.string() + ".import",
                    fmt::format("[remap]\n\nimporter=\"texture_array\"\ntype=\"TextureArray\"\n\n[params]\n\n"
                                "compress/mode=0\nflags/repeat=0\nflags/filter={0}\nflags/mipmaps={0}\nflags/srgb=0\n"
                                "slices/horizontal={1}\nslices/vertical={2}\n",
                                filtered, columns, rows));
}

/// Positions and UVs in floats, not halves; no material file beside the scene.
void writeSceneImport(const fs::path& folder) {
  io::writeTextFile(folder / "scene.gltf.import",
                    "[remap]\n\nimporter=\"scene\"\ntype=\"PackedScene\"\n\n[params]\n\n"
                    "materials/location=0\nmaterials/storage=0\nmeshes/compress=false\nmeshes/ensure_tangents=true\n"
                    "animation/import=false\n");
}

void writeTextures(const Package& package, const std::vector<EngineMap>& maps, const fs::path& folder,
                   Progress& progress) {
  const fs::path textures = folder / "textures";
  io::createDirectories(textures);
  for (const EngineMap& map : maps) {
    writeNeutral(package, map, textures, progress);
    writeTextureImport(textures / (map.id + "_neutral.png"));
    writeStack(package, map, textures, progress);
    const StackLayout layout = stackLayout(package, map);
    writeArrayImport(textures / (map.id + "_differences.png"), layout.columns, layout.rows, Filter::kMipmaps);
  }
  writeWeights(package, maps, textures, progress);
  for (const int set : usedSets(maps)) {
    const PackageWeights& weights = package.weightSets()[static_cast<std::size_t>(set)];
    for (std::size_t f = 0; f < weights.files.size(); ++f) {
      writeArrayImport(textures / fmt::format("weights_{}_{}.png", set, f), weights.columns, weights.rows,
                       Filter::kNone);
    }
  }
}

struct Uniform {
  std::string name;
  const char* type;
};

/// Textures of the material: uniforms by the names of their files.
std::vector<Uniform> materialTextures(const Package& package, const std::vector<EngineMap>& maps) {
  std::vector<Uniform> uniforms;
  for (const EngineMap& map : maps) {
    uniforms.push_back({map.id + "_neutral", "Texture"});
    uniforms.push_back({map.id + "_differences", "TextureArray"});
  }
  for (const int set : usedSets(maps)) {
    const std::size_t files = package.weightSets()[static_cast<std::size_t>(set)].files.size();
    for (std::size_t f = 0; f < files; ++f) uniforms.push_back({fmt::format("weights_{}_{}", set, f), "TextureArray"});
  }
  return uniforms;
}

void writeMaterial(const Package& package, const std::vector<EngineMap>& maps, const fs::path& file) {
  const std::vector<Uniform> uniforms = materialTextures(package, maps);
  std::string text =
      fmt::format("[gd_resource type=\"ShaderMaterial\" load_steps={} format=2]\n\n", uniforms.size() + 2);
  std::string parameters;
  text += "[ext_resource path=\"face.shader\" type=\"Shader\" id=1]\n";
  for (std::size_t i = 0; i < uniforms.size(); ++i) {
    const auto& [name, type] = uniforms[i];
    text += fmt::format("[ext_resource path=\"textures/{}.png\" type=\"{}\" id={}]\n", name, type, i + 2);
    parameters += fmt::format("shader_param/{} = ExtResource( {} )\n", name, i + 2);
  }
  io::writeTextFile(file,
                    text + "\n[resource]\nshader = ExtResource( 1 )\nshader_param/facezip_count = 0\n" + parameters);
}

void writeScene(const Package& package, const fs::path& file) {
  std::vector<std::string> names;
  for (const std::string& name : package.expressions()) names.push_back(quote(name));
  io::writeTextFile(file, fmt::format(R"([gd_scene load_steps=4 format=2]

[ext_resource path="facezip_face.gd" type="Script" id=1]
[ext_resource path="face.material.tres" type="Material" id=2]
[ext_resource path="scene.gltf" type="PackedScene" id=3]

[node name="Face" type="Spatial"]
script = ExtResource( 1 )
material = ExtResource( 2 )
expressions = PoolStringArray( {} )

[node name="Head" parent="." instance=ExtResource( 3 )]
)",
                                      fmt::join(names, ", ")));
}

/// A project that shows the face when it is run, and the scene that it runs.
void writeProject(const Package& package, const fs::path& folder) {
  io::writeTextFile(
      folder / "project.godot",
      fmt::format("config_version=4\n\n[application]\n\nconfig/name={}\nrun/main_scene=\"res://demo.tscn\"\n\n"
                  "[rendering]\n\nquality/driver/driver_name=\"GLES3\"\n",
                  quote(package.name().empty() ? "face" : package.name())));
  io::writeTextFile(folder / "demo.tscn", R"([gd_scene load_steps=3 format=2]

[ext_resource path="face.tscn" type="PackedScene" id=1]
[ext_resource path="demo.gd" type="Script" id=2]

[node name="Demo" type="Spatial"]
script = ExtResource( 2 )

[node name="Face" parent="." instance=ExtResource( 1 )]

[node name="Light" type="DirectionalLight" parent="."]
transform = Transform( 0.866, -0.25, 0.433, 0, 0.866, 0.5, -0.5, -0.433, 0.75, 0, 0, 0 )

[node name="Camera" type="Camera" parent="."]
fov = 30.0
)");
}

}  // namespace

void writeGodot(const Package& package, const fs::path& folder, Progress& progress) {
  const std::vector<EngineMap> maps = engineMaps(package);
  requireMaps(package, maps);
  writeTextures(package, maps, folder, progress);
  writeSceneImport(folder);
  io::writeTextFile(folder / "face.shader", godotShader(package, maps));
  writeMaterial(package, maps, folder / "face.material.tres");
  writeScene(package, folder / "face.tscn");
  writeProject(package, folder);
}

}  // namespace facezip::exporting
