#include "mesh/package_mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <utility>
#include <vector>

#include "facezip/version.hpp"
#include "io/folder.hpp"
#include "io/json_field.hpp"
#include "io/memory_bound.hpp"
#include "io/safe_names.hpp"
#include "scene/glb.hpp"
#include "scene/gltf_accessors.hpp"

namespace facezip::mesh {
namespace {
using io::JsonField;
using nlohmann::json;
using scene::Accessor;
using scene::GltfAccessors;
using scene::kFloat;
using Bytes = std::span<const std::byte>;

constexpr const char* kCure = "the mesh is damaged: write the package again";

/// Attributes that a mesh or its morph targets may have, of floats. Others are left out.
struct Attribute {
  const char* name;
  int components;
};
constexpr Attribute kOfMesh[] = {{"POSITION", 3}, {"NORMAL", 3}, {"TANGENT", 4}, {"TEXCOORD_0", 2}};
constexpr Attribute kOfTargets[] = {{"POSITION", 3}, {"NORMAL", 3}, {"TANGENT", 3}};

/// What may be missing, and if it is there must be empty.
void requireNone(const JsonField& root, const char* key) {
  if (root.has(key)) root[key].elements(0, 0);
}

/// The one buffer, which is in the file: another file is never asked for.
Bytes bufferOf(const JsonField& root, Bytes binary) {
  const JsonField buffer = root["buffers"].elements(1, 1)[0];
  if (buffer.has("uri")) buffer["uri"].fail("none: the buffer is in the file", buffer["uri"].got());
  return binary.first(static_cast<std::size_t>(buffer["byteLength"].integer(1, static_cast<int>(binary.size()))));
}

/// Attributes by name, each with one vector of floats for every vertex.
template <typename Attributes>
json attributesJson(const JsonField& field, const Attributes& known, const GltfAccessors& accessors,
                    std::size_t vertices) {
  json attributes = json::object();
  for (const Attribute& attribute : known) {
    if (!field.has(attribute.name)) continue;
    const JsonField reference = field[attribute.name];
    const Accessor& accessor = accessors.at(reference);
    if (accessor.component_type != kFloat || accessor.components != attribute.components ||
        accessor.count != vertices) {
      reference.fail(fmt::format("{} vectors of {} floats", vertices, attribute.components),
                     fmt::format("{} of {}, of type {}", accessor.count, accessor.components, accessor.component_type));
    }
    attributes[attribute.name] = reference.integer(0, static_cast<int>(accessors.size()));
  }
  return attributes;
}

void requireTriangles(const JsonField& reference, const GltfAccessors& accessors, std::size_t vertices) {
  const Accessor& indices = accessors.at(reference);
  const bool fits = indices.component_type != kFloat && indices.components == 1 && indices.count % 3 == 0 &&
                    indices.elements && !indices.sparse;
  if (!fits) reference.fail("three indices for each triangle", "other numbers");
  for (std::size_t i = 0; i < indices.count; ++i) {
    const std::size_t vertex = indices.elements->index(i, indices.component_type);
    if (vertex >= vertices) {
      reference.fail(fmt::format("indices below {}", vertices), fmt::format("{} at {}", vertex, i));
    }
  }
}

json targetNamesJson(const JsonField& mesh, std::size_t targets) {
  json names = json::array();
  std::set<std::string> seen;
  for (const JsonField& field : mesh["extras"]["targetNames"].elements(targets, targets)) {
    names.push_back(io::fileSafeName(field));
    if (!seen.insert(names.back()).second) field.fail("unique names", field.got() + " twice");
  }
  return names;
}

/// Arrays of zeros take room in loaders, and none in the file.
void requireNoLargerZeros(const JsonField& root, const GltfAccessors& accessors, std::size_t vertices) {
  const std::vector<JsonField> fields = root["accessors"].elements(0, accessors.size());
  for (std::size_t i = 0; i < accessors.size(); ++i) {
    if (accessors[i].elements || accessors[i].count == vertices) continue;
    fields[i]["count"].fail(fmt::format("{}, the number of vertices", vertices), fields[i]["count"].got());
  }
}

/// The mesh anew, of what is known.
json meshJson(const JsonField& root, const GltfAccessors& accessors, PackageMesh& found) {
  const JsonField mesh = root["meshes"].elements(1, 1)[0];
  const JsonField primitive = mesh["primitives"].elements(1, 1)[0];
  if (primitive.has("mode")) primitive["mode"].integer(4, 4);  // triangles
  const JsonField position = primitive["attributes"]["POSITION"];
  if (!accessors.at(position).elements) position.fail("positions that are stored", "none");
  found.vertices = accessors.at(position).count;
  requireTriangles(primitive["indices"], accessors, found.vertices);
  json clean = {{"attributes", attributesJson(primitive["attributes"], kOfMesh, accessors, found.vertices)},
                {"indices", primitive["indices"].integer(0, static_cast<int>(accessors.size()))},
                {"material", 0},
                {"mode", 4}};
  if (primitive.has("targets")) {
    for (const JsonField& target : primitive["targets"].elements(0, kMostTargets)) {
      json attributes = attributesJson(target, kOfTargets, accessors, found.vertices);
      if (!attributes.contains("POSITION")) target.fail("a target that moves positions", "another");
      clean["targets"].push_back(std::move(attributes));
    }
    found.targets = clean.contains("targets") ? clean["targets"].size() : 0;
    if (found.targets * found.vertices > kMostMovedVertices) {
      primitive["targets"].fail(fmt::format("targets times vertices of at most {}", kMostMovedVertices),
                                fmt::format("{} x {}", found.targets, found.vertices));
    }
  }
  requireNoLargerZeros(root, accessors, found.vertices);
  json whole = {{"name", mesh.has("name") ? mesh["name"].text() : "face"}, {"primitives", json::array({clean})}};
  if (found.targets == 0) return whole;
  whole["weights"] = std::vector<double>(found.targets, 0.0);
  whole["extras"] = {{"targetNames", targetNamesJson(mesh, found.targets)}};
  return whole;
}

}  // namespace

PackageMesh parsePackageMesh(std::string glb, const std::string& file) {
  PackageMesh mesh;
  mesh.file = std::make_shared<const std::string>(std::move(glb));
  const scene::GlbParts parts = scene::splitGlb(std::as_bytes(std::span(*mesh.file)), file);
  const json document = io::parseJson(parts.json, file, kCure);
  const JsonField root(document, file, "", kCure);
  const JsonField version = root["asset"]["version"];
  if (version.text() != "2.0") version.fail("\"2.0\"", version.got());
  // Extensions that must be known: what compressed meshes take unpacked, for example, is not. Images are files.
  for (const char* key : {"extensionsRequired", "images", "textures"}) requireNone(root, key);
  mesh.buffer = bufferOf(root, parts.binary);
  const GltfAccessors accessors(root, mesh.buffer);
  json found = meshJson(root, accessors, mesh);
  const json name = found["name"];
  const json skin = {{"metallicFactor", 0.0}, {"roughnessFactor", 0.6}};
  mesh.document = {{"asset", {{"version", "2.0"}, {"generator", "facezip " FACEZIP_VERSION}}},
                   {"buffers", json::array({{{"byteLength", mesh.buffer.size()}}})},
                   {"bufferViews", accessors.viewsJson()},
                   {"accessors", accessors.accessorsJson()},
                   {"materials", json::array({{{"name", name}, {"pbrMetallicRoughness", skin}}})},
                   {"meshes", json::array({std::move(found)})},
                   {"nodes", json::array({{{"mesh", 0}, {"name", name}}})},
                   {"scenes", json::array({{{"nodes", json::array({0})}}})},
                   {"scene", 0}};
  return mesh;
}

PackageMesh readPackageMesh(const Package& package, std::uint64_t memory_bytes) {
  const std::string& name = package.description().mesh_file;
  const std::string path = (package.directory() / name).string();
  const InputFile file = package.folder().open(name, "the mesh of the package", "write the package again");
  // The file, its text as values, and, where it is exported, three copies of its numbers.
  io::requireMemory(5 * file.size(), memory_bytes, path);
  return parsePackageMesh(file.read(kMostMeshBytes), path);
}

std::string packageMeshFile(const PackageMesh& mesh) { return scene::joinGlb(mesh.document.dump(), mesh.buffer); }

}  // namespace facezip::mesh
