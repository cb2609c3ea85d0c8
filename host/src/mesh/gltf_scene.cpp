#include "mesh/gltf_scene.hpp"

#include <fmt/format.h>

// A system header: its own warnings are not ours.
#include <tiny_gltf.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <cctype>
#include <limits>
#include <span>
#include <utility>

#include "facezip/error.hpp"
#include "facezip/geometry/float_origin.hpp"
#include "facezip/version.hpp"
#include "mesh/gltf_buffer.hpp"
#include "mesh/gltf_tangents.hpp"

namespace facezip::mesh {
namespace fs = std::filesystem;
namespace {

tinygltf::Value toValue(const nlohmann::json& json) {
  if (json.is_boolean()) return tinygltf::Value(json.get<bool>());
  if (json.is_number_integer()) return tinygltf::Value(json.get<int>());
  if (json.is_number()) return tinygltf::Value(json.get<double>());
  if (json.is_string()) return tinygltf::Value(json.get<std::string>());
  if (json.is_array()) {
    tinygltf::Value::Array array;
    for (const nlohmann::json& element : json) array.push_back(toValue(element));
    return tinygltf::Value(array);
  }
  assert(json.is_object());
  tinygltf::Value::Object object;
  for (const auto& [key, element] : json.items()) object[key] = toValue(element);
  return tinygltf::Value(object);
}

/// Rows of `matrix`, as split vertices have them.
std::vector<float> gather(const Eigen::MatrixXd& matrix, std::span<const int> rows) {
  std::vector<float> values;
  values.reserve(rows.size() * static_cast<std::size_t>(matrix.cols()));
  for (const int row : rows) {
    for (Eigen::Index c = 0; c < matrix.cols(); ++c) values.push_back(static_cast<float>(matrix(row, c)));
  }
  return values;
}

/// The scene's positions and targets, as these triangles of them.
tinygltf::Primitive makePrimitive(const GltfScene& scene, const Eigen::MatrixX3i& triangles,
                                  const Eigen::MatrixX3i& uv_triangles, GltfBuffer& accessors) {
  const SplitVertices split = splitVertices(triangles, uv_triangles);
  const Eigen::MatrixX3d neutral = scene.neutral.positions * scene.metres_per_unit;
  const Eigen::MatrixX3d normals = vertexNormals(neutral, triangles);
  tinygltf::Primitive primitive;
  primitive.mode = TINYGLTF_MODE_TRIANGLES;
  primitive.indices = accessors.addIndices(split.corners);
  primitive.attributes["POSITION"] = accessors.addFloats(gather(neutral, split.positions), 3, true);
  primitive.attributes["NORMAL"] = accessors.addFloats(gather(normals, split.positions), 3, false);
  if (uv_triangles.rows() > 0) {
    Eigen::MatrixX2d uvs = scene.neutral.uvs;
    uvs.col(1) = 1.0 - uvs.col(1).array();
    primitive.attributes["TEXCOORD_0"] = accessors.addFloats(gather(uvs, split.uvs), 2, false);
  }
  for (const MorphTarget& target : scene.targets) {
    if (target.positions.rows() != neutral.rows()) {
      throw InputError({"", target.name, fmt::format("{} vertices as the neutral has", neutral.rows()),
                        fmt::format("{}", target.positions.rows()), ""});
    }
    const Eigen::MatrixX3d moved = target.positions * scene.metres_per_unit;
    const Eigen::MatrixX3d turned = vertexNormals(moved, triangles);
    std::map<std::string, int>& attributes = primitive.targets.emplace_back();
    attributes["POSITION"] = accessors.addSparse(gather(moved - neutral, split.positions), true);
    attributes["NORMAL"] = accessors.addSparse(gather(turned - normals, split.positions), false);
  }
  return primitive;
}

/// A relative path as a URI (RFC 3986).
std::string percentEncoded(const std::string& path) {
  std::string uri;
  for (const char c : path) {
    const auto byte = static_cast<unsigned char>(c);
    const bool plain = std::isalnum(byte) != 0 || std::string_view("-._~/").find(c) != std::string_view::npos;
    uri += plain ? std::string(1, c) : fmt::format("%{:02X}", byte);
  }
  return uri;
}

int addSampler(tinygltf::Model& model, int wrap) {
  tinygltf::Sampler sampler;
  sampler.minFilter = TINYGLTF_TEXTURE_FILTER_LINEAR_MIPMAP_LINEAR;
  sampler.magFilter = TINYGLTF_TEXTURE_FILTER_LINEAR;
  sampler.wrapS = sampler.wrapT = wrap;
  model.samplers.push_back(std::move(sampler));
  return static_cast<int>(model.samplers.size()) - 1;
}

int addTexture(tinygltf::Model& model, const std::string& uri, int sampler) {
  tinygltf::Image image;
  image.uri = percentEncoded(uri);
  model.images.push_back(std::move(image));
  tinygltf::Texture texture;
  texture.source = static_cast<int>(model.images.size()) - 1;
  texture.sampler = sampler;
  model.textures.push_back(std::move(texture));
  return static_cast<int>(model.textures.size()) - 1;
}

/// Puts textures and extras into `material`, a material of `model`.
void setMaterial(const GltfMaterial& from, tinygltf::Material& material, tinygltf::Model& model) {
  const bool textured =
      !(from.base_colour_texture + from.normal_texture + from.roughness_texture + from.occlusion_texture).empty();
  const int sampler = textured ? addSampler(model, TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE) : -1;
  const auto add = [&](const std::string& file) { return addTexture(model, file, sampler); };
  if (!from.base_colour_texture.empty()) {
    material.pbrMetallicRoughness.baseColorTexture.index = add(from.base_colour_texture);
  }
  if (!from.normal_texture.empty()) material.normalTexture.index = add(from.normal_texture);
  if (!from.roughness_texture.empty()) {  // whose green counts; metal, its blue, times 0
    material.pbrMetallicRoughness.metallicRoughnessTexture.index = add(from.roughness_texture);
    material.pbrMetallicRoughness.roughnessFactor = 1.0;
  }
  if (!from.occlusion_texture.empty()) material.occlusionTexture.index = add(from.occlusion_texture);
  if (from.extras.is_object()) material.extras = toValue(from.extras);
}

tinygltf::Material makeMaterial(const GltfScene& scene, tinygltf::Model& model) {
  tinygltf::Material material;
  material.name = scene.name;
  material.pbrMetallicRoughness.metallicFactor = 0.0;
  material.pbrMetallicRoughness.roughnessFactor = 0.6;  // of skin, roughly
  setMaterial({scene.base_colour_texture, scene.normal_texture, "", "", scene.material_extras}, material, model);
  return material;
}

/// The material of a part, its texture included. UVs of parts may lie in tiles beyond the first: textures repeat.
tinygltf::Material makeMaterial(const PackageMaterial& part, tinygltf::Model& model) {
  tinygltf::Material material;
  material.name = part.name;
  tinygltf::PbrMetallicRoughness& look = material.pbrMetallicRoughness;
  look.baseColorFactor = {part.colour[0], part.colour[1], part.colour[2], part.opacity};
  look.metallicFactor = 0.0;
  look.roughnessFactor = part.roughness;
  if (!part.texture.empty()) {
    look.baseColorTexture.index = addTexture(model, part.texture, addSampler(model, TINYGLTF_TEXTURE_WRAP_REPEAT));
  }
  const nlohmann::json json = materialJson(part);
  material.alphaMode = json.value("alphaMode", "OPAQUE");
  material.doubleSided = json.value("doubleSided", false);
  return material;
}

/// Appends what `from` has in its buffer to that of `to`, and its one mesh's primitives to the one of `to`.
void appendPrimitives(const tinygltf::Model& from, tinygltf::Model& to) {
  std::vector<unsigned char>& data = to.buffers.at(0).data;
  data.resize((data.size() + 3) / 4 * 4);
  const auto views = static_cast<int>(to.bufferViews.size());
  const auto first = static_cast<int>(to.accessors.size());
  const auto material = static_cast<int>(to.materials.size());
  for (tinygltf::BufferView view : from.bufferViews) {
    view.byteOffset += data.size();
    to.bufferViews.push_back(std::move(view));
  }
  const std::vector<unsigned char>& bytes = from.buffers.at(0).data;
  data.insert(data.end(), bytes.begin(), bytes.end());
  for (tinygltf::Accessor accessor : from.accessors) {
    if (accessor.bufferView >= 0) accessor.bufferView += views;
    if (accessor.sparse.isSparse) {
      accessor.sparse.indices.bufferView += views;
      accessor.sparse.values.bufferView += views;
    }
    to.accessors.push_back(std::move(accessor));
  }
  for (tinygltf::Primitive primitive : from.meshes.at(0).primitives) {
    for (auto& [name, accessor] : primitive.attributes) accessor += first;
    for (std::map<std::string, int>& target : primitive.targets) {
      for (auto& [name, accessor] : target) accessor += first;
    }
    primitive.indices += first;
    primitive.material += material;
    to.meshes.at(0).primitives.push_back(std::move(primitive));
  }
}

tinygltf::Model loadMesh(const PackageMesh& mesh) {
  const std::string file = packageMeshFile(mesh);
  tinygltf::Model model;
  std::string error, warning;
  tinygltf::TinyGLTF loader;
  loader.SetFsCallbacks({});  // no file is needed, and none is to be had
  const bool loaded =
      loader.LoadBinaryFromMemory(&model, &error, &warning, reinterpret_cast<const unsigned char*>(file.data()),
                                  static_cast<unsigned int>(file.size()));
  if (!loaded) throw Error(fmt::format("the mesh of the package cannot be exported: {}", error));
  return model;
}

tinygltf::Mesh makeMesh(const GltfScene& scene, std::vector<tinygltf::Primitive> primitives) {
  tinygltf::Mesh mesh;
  mesh.name = scene.name;
  mesh.primitives = std::move(primitives);
  mesh.weights.assign(scene.targets.size(), 0.0);
  tinygltf::Value::Array names;
  for (const MorphTarget& target : scene.targets) names.emplace_back(target.name);
  tinygltf::Value::Object extras;
  if (!names.empty()) extras["targetNames"] = tinygltf::Value(names);
  if (!scene.origin.isZero(0.0)) {
    tinygltf::Value::Array origin;
    for (const double metres : scene.metres_per_unit* scene.origin) origin.emplace_back(metres);
    extras["origin"] = tinygltf::Value(origin);
  }
  if (!extras.empty()) mesh.extras = tinygltf::Value(extras);
  return mesh;
}

/// tinygltf says nothing of a full disk.
void requireWritten(const fs::path& file, std::size_t least_bytes) {
  std::error_code error;
  const std::uintmax_t bytes = fs::file_size(file, error);
  if (error || bytes < least_bytes) throw OutputError(file, "could not be written whole", "is the disk full?");
}

void save(const tinygltf::Model& model, const fs::path& file) {
  const bool binary = file.extension() == ".glb";
  tinygltf::TinyGLTF writer;
  // Textures stay where they are: a writer that writes nothing keeps their paths.
  writer.SetImageWriter(
      [](const std::string*, const std::string*, const tinygltf::Image*, bool, std::string*, void*) { return false; },
      nullptr);
  if (!writer.WriteGltfSceneToFile(&model, file.string(), false, false, /*prettyPrint=*/true, binary)) {
    throw OutputError(file, "could not be written", "");
  }
  requireWritten(binary ? file : fs::path(file).replace_extension(".bin"), model.buffers.at(0).data.size());
  requireWritten(file, 1);
}

}  // namespace

SplitVertices splitVertices(const Eigen::MatrixX3i& triangles, const Eigen::MatrixX3i& uv_triangles) {
  const bool has_uvs = uv_triangles.rows() > 0;
  const auto corner = [&](Eigen::Index t, int c) {
    return std::pair(triangles(t, c), has_uvs ? uv_triangles(t, c) : -1);
  };
  std::vector<std::pair<int, int>> pairs;
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    for (int c = 0; c < 3; ++c) pairs.push_back(corner(t, c));
  }
  std::ranges::sort(pairs);
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  SplitVertices split;
  for (const auto& [position, uv] : pairs) {
    split.positions.push_back(position);
    split.uvs.push_back(uv);
  }
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    for (int c = 0; c < 3; ++c) {
      split.corners.push_back(static_cast<int>(std::ranges::lower_bound(pairs, corner(t, c)) - pairs.begin()));
    }
  }
  return split;
}

Eigen::MatrixX3d vertexNormals(const Eigen::MatrixX3d& positions, const Eigen::MatrixX3i& triangles) {
  Eigen::MatrixX3d normals = Eigen::MatrixX3d::Zero(positions.rows(), 3);
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    const Eigen::RowVector3d a = positions.row(triangles(t, 0));
    const Eigen::RowVector3d b = positions.row(triangles(t, 1));
    const Eigen::RowVector3d c = positions.row(triangles(t, 2));
    const Eigen::RowVector3d area = (b - a).cross(c - a);
    for (int corner = 0; corner < 3; ++corner) normals.row(triangles(t, corner)) += area;
  }
  for (Eigen::Index v = 0; v < normals.rows(); ++v) {
    const double length = normals.row(v).norm();
    if (length > 0.0) {
      normals.row(v) /= length;
    } else {
      normals.row(v) << 0.0, 0.0, 1.0;
    }
  }
  return normals;
}

Eigen::RowVector3d recentre(GltfScene& scene) {
  const Eigen::RowVector3d origin = geometry::floatOrigin(scene.neutral.positions);
  recentre(scene, origin);
  return origin;
}

void recentre(GltfScene& scene, const Eigen::RowVector3d& origin) {
  if (origin.isZero(0.0)) return;
  scene.origin += origin;
  scene.neutral.positions.rowwise() -= origin;
  for (MorphTarget& target : scene.targets) target.positions.rowwise() -= origin;
}

void writeGltf(const fs::path& file, const GltfScene& scene) {
  tinygltf::Model model;
  model.asset.version = "2.0";
  model.asset.generator = "facezip " FACEZIP_VERSION;
  model.buffers.emplace_back();
  GltfBuffer accessors(model);
  std::vector<tinygltf::Primitive> primitives;
  if (scene.neutral.triangles.rows() > 0) {
    primitives.push_back(makePrimitive(scene, scene.neutral.triangles, scene.neutral.uv_triangles, accessors));
    model.materials.push_back(makeMaterial(scene, model));
  }
  for (const ScenePart& part : scene.parts) {
    primitives.push_back(makePrimitive(scene, part.triangles, part.uv_triangles, accessors));
    model.materials.push_back(makeMaterial(part.material, model));
  }
  for (std::size_t p = 0; p < primitives.size(); ++p) primitives[p].material = static_cast<int>(p);
  model.meshes.push_back(makeMesh(scene, std::move(primitives)));
  tinygltf::Node node;
  node.name = scene.name;
  node.mesh = 0;
  model.nodes.push_back(std::move(node));
  tinygltf::Scene nodes;
  nodes.nodes.push_back(0);
  model.scenes.push_back(std::move(nodes));
  model.defaultScene = 0;
  if (!scene.normal_texture.empty()) addTangents(model);
  save(model, file);
}

void addBlendToGltf(const PackageMesh& mesh, const GltfParts* parts, const fs::path& to, const GltfMaterial& material) {
  tinygltf::Model model = loadMesh(mesh);
  setMaterial(material, model.materials.at(0), model);
  if (parts != nullptr) {
    appendPrimitives(loadMesh(parts->mesh), model);
    for (const PackageMaterial& part : parts->materials) model.materials.push_back(makeMaterial(part, model));
  }
  addTangents(model);  // whatever shader draws it may have a normal map
  save(model, to);
}

}  // namespace facezip::mesh
