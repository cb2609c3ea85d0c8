#include "mesh/package_mesh.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

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
void requireNoLargerZeros(const JsonField& root, const GltfAccessors& accessors,
                          const std::set<std::size_t>& vertices) {
  const std::vector<JsonField> fields = root["accessors"].elements(0, accessors.size());
  for (std::size_t i = 0; i < accessors.size(); ++i) {
    if (accessors[i].elements || vertices.contains(accessors[i].count)) continue;
    fields[i]["count"].fail(fmt::format("{}, the number of vertices", fmt::join(vertices, " or ")),
                            fields[i]["count"].got());
  }
}

/// A primitive anew, of what is known; of the vertices and targets it takes the room left.
json primitiveJson(const JsonField& primitive, const GltfAccessors& accessors, std::size_t& vertices,
                   std::size_t& room) {
  if (primitive.has("mode")) primitive["mode"].integer(4, 4);  // triangles
  const JsonField position = primitive["attributes"]["POSITION"];
  if (!accessors.at(position).elements) position.fail("positions that are stored", "none");
  vertices = accessors.at(position).count;
  requireTriangles(primitive["indices"], accessors, vertices);
  json clean = {{"attributes", attributesJson(primitive["attributes"], kOfMesh, accessors, vertices)},
                {"indices", primitive["indices"].integer(0, static_cast<int>(accessors.size()))},
                {"mode", 4}};
  if (!primitive.has("targets")) return clean;
  const std::vector<JsonField> targets = primitive["targets"].elements(0, kMostTargets);
  if (targets.size() * vertices > room) {
    primitive["targets"].fail(fmt::format("targets times vertices of at most {}", kMostMovedVertices),
                              fmt::format("{} x {}", targets.size(), vertices));
  }
  room -= targets.size() * vertices;
  for (const JsonField& target : targets) {
    json attributes = attributesJson(target, kOfTargets, accessors, vertices);
    if (!attributes.contains("POSITION")) target.fail("a target that moves positions", "another");
    clean["targets"].push_back(std::move(attributes));
  }
  return clean;
}

/// The mesh anew, of what is known. Each primitive has the material of its number, and all have as many targets.
json meshJson(const JsonField& root, const GltfAccessors& accessors, std::size_t primitives, PackageMesh& found) {
  const JsonField mesh = root["meshes"].elements(1, 1)[0];
  json clean = json::array();
  std::set<std::size_t> counts;
  std::size_t room = kMostMovedVertices;
  for (const JsonField& primitive : mesh["primitives"].elements(primitives, primitives)) {
    std::size_t vertices = 0;
    json one = primitiveJson(primitive, accessors, vertices, room);
    one["material"] = clean.size();
    const std::size_t targets = one.contains("targets") ? one["targets"].size() : 0;
    if (clean.empty()) found.targets = targets;
    if (targets != found.targets) {
      primitive.fail(fmt::format("{} targets as the first has", found.targets), fmt::format("{}", targets));
    }
    found.vertices += vertices;
    counts.insert(vertices);
    clean.push_back(std::move(one));
  }
  requireNoLargerZeros(root, accessors, counts);
  json whole = {{"name", mesh.has("name") ? mesh["name"].text() : "face"}, {"primitives", std::move(clean)}};
  if (found.targets == 0) return whole;
  whole["weights"] = std::vector<double>(found.targets, 0.0);
  whole["extras"] = {{"targetNames", targetNamesJson(mesh, found.targets)}};
  return whole;
}

const json& targetNamesOf(const PackageMesh& mesh) {
  static const json none = json::array();
  const json& found = mesh.document.at("meshes")[0];
  return found.contains("extras") ? found["extras"]["targetNames"] : none;
}

/// materials  of the primitives; null: one, whose name is the mesh's
PackageMesh parseMesh(std::string glb, const std::string& file, json materials) {
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
  json found = meshJson(root, accessors, materials.is_null() ? 1 : materials.size(), mesh);
  const json name = found["name"];
  const json skin = {{"metallicFactor", 0.0}, {"roughnessFactor", 0.6}};
  if (materials.is_null()) materials = json::array({{{"name", name}, {"pbrMetallicRoughness", skin}}});
  mesh.document = {{"asset", {{"version", "2.0"}, {"generator", "facezip " FACEZIP_VERSION}}},
                   {"buffers", json::array({{{"byteLength", mesh.buffer.size()}}})},
                   {"bufferViews", accessors.viewsJson()},
                   {"accessors", accessors.accessorsJson()},
                   {"materials", std::move(materials)},
                   {"meshes", json::array({std::move(found)})},
                   {"nodes", json::array({{{"mesh", 0}, {"name", name}}})},
                   {"scenes", json::array({{{"nodes", json::array({0})}}})},
                   {"scene", 0}};
  return mesh;
}

/// The file's bytes, where they, their text as values and, if it is exported, three copies of its numbers have room.
std::string readWhole(const Package& package, const std::string& name, std::uint64_t memory_bytes) {
  const InputFile file = package.folder().open(name, "the mesh of the package", "write the package again");
  io::requireMemory(5 * file.size(), memory_bytes, (package.directory() / name).string());
  return file.read(kMostMeshBytes);
}

}  // namespace

PackageMesh parsePackageMesh(std::string glb, const std::string& file) { return parseMesh(std::move(glb), file, {}); }

PackageMesh parsePackageParts(std::string glb, const std::string& file, const PackageParts& parts,
                              const PackageMesh& mesh) {
  json materials = json::array();
  for (const PackageMaterial& material : parts.materials) materials.push_back(materialJson(material));
  PackageMesh found = parseMesh(std::move(glb), file, std::move(materials));
  if (targetNamesOf(found) != targetNamesOf(mesh)) {
    throw InputError(
        {file, "meshes[0].extras.targetNames", "those of the package's mesh, in their order", "others", kCure});
  }
  return found;
}

PackageMesh readPackageMesh(const Package& package, std::uint64_t memory_bytes) {
  const std::string& name = package.description().mesh_file;
  return parsePackageMesh(readWhole(package, name, memory_bytes), (package.directory() / name).string());
}

PackageMesh readPackageParts(const Package& package, const PackageMesh& mesh, std::uint64_t memory_bytes) {
  const PackageParts& parts = *package.description().parts;
  return parsePackageParts(readWhole(package, parts.file, memory_bytes), (package.directory() / parts.file).string(),
                           parts, mesh);
}

json materialJson(const PackageMaterial& material) {
  json made = {{"name", material.name},
               {"pbrMetallicRoughness",
                {{"baseColorFactor", {material.colour[0], material.colour[1], material.colour[2], material.opacity}},
                 {"metallicFactor", 0.0},
                 {"roughnessFactor", material.roughness}}}};
  // Cards and linings are seen from both sides; the far side of what one looks through would be drawn over the near.
  const bool blended = material.alpha == PackageMaterial::Alpha::kBlend;
  if (!blended) made["doubleSided"] = true;
  if (blended) made["alphaMode"] = "BLEND";
  if (material.alpha == PackageMaterial::Alpha::kMask) made["alphaMode"] = "MASK";
  return made;
}

std::string packageMeshFile(const PackageMesh& mesh) { return scene::joinGlb(mesh.document.dump(), mesh.buffer); }

}  // namespace facezip::mesh
