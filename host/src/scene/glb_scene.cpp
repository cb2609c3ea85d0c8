#include "scene/glb_scene.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <optional>

#include "io/counts.hpp"
#include "io/read_file.hpp"
#include "scene/glb.hpp"
#include "scene/gltf_accessors.hpp"

namespace facezip::scene {
namespace {
namespace fs = std::filesystem;
using io::JsonField;

constexpr std::uintmax_t kMostBytes = std::uintmax_t{2} << 30;
constexpr std::size_t kMost = 65536;  // nodes, meshes, materials, images, targets
constexpr int kDeepest = 64;
constexpr int kTriangles = 4;
constexpr double kFarthest = 1e12;  // of anything that a node says
constexpr const char* kCure = "export plain glTF 2.0, binary, all in one file, without compression";

std::vector<JsonField> membersOf(const JsonField& root, const char* key) {
  return root.has(key) ? root[key].elements(0, kMost) : std::vector<JsonField>();
}

/// count  numbers of an array, or what stands in their place
std::vector<double> numbersOf(const JsonField& node, const char* key, std::vector<double> otherwise) {
  if (!node.has(key)) return otherwise;
  std::vector<double> numbers;
  for (const JsonField& field : node[key].elements(otherwise.size(), otherwise.size())) {
    numbers.push_back(field.number(-kFarthest, kFarthest));
  }
  return numbers;
}

Eigen::Affine3d placeOf(const JsonField& node) {
  Eigen::Affine3d place = Eigen::Affine3d::Identity();
  if (node.has("matrix")) {
    const std::vector<double> m = numbersOf(node, "matrix", std::vector<double>(16));
    place.matrix() = Eigen::Map<const Eigen::Matrix4d>(m.data());  // by columns, both
    if (!place.matrix().row(3).isApprox(Eigen::RowVector4d(0, 0, 0, 1)))
      node["matrix"].fail("an affine one", "another");
    return place;
  }
  const std::vector<double> t = numbersOf(node, "translation", {0, 0, 0}),
                            r = numbersOf(node, "rotation", {0, 0, 0, 1}), s = numbersOf(node, "scale", {1, 1, 1});
  const Eigen::Quaterniond turn(r[3], r[0], r[1], r[2]);
  if (!(turn.norm() > 0.5)) node["rotation"].fail("a quaternion of length 1", node["rotation"].got());
  place.translate(Eigen::Vector3d(t[0], t[1], t[2])).rotate(turn.normalized()).scale(Eigen::Vector3d(s[0], s[1], s[2]));
  return place;
}

std::string nameOf(const JsonField& named) { return named.has("name") ? named["name"].text() : ""; }

Eigen::RowVector3d vectorAt(const Elements& elements, std::size_t i) {
  return {double{elements.at<float>(i, 0)}, double{elements.at<float>(i, 1)}, double{elements.at<float>(i, 2)}};
}

class SceneReader {
 public:
  explicit SceneReader(const GlbFile& file)
      : accessors_(file.root(), file.binary(), OtherNumbers::kLeftOut),
        nodes_(file.members("nodes")),
        meshes_(file.members("meshes")),
        materials_(static_cast<int>(file.members("materials").size())) {
    const JsonField root = file.root();
    // Without a scene, every mesh where it lies.
    if (nodes_.empty()) {
      for (const JsonField& mesh : meshes_) addMesh(mesh, Eigen::Affine3d::Identity(), "");
      return;
    }
    const std::vector<JsonField> scenes = file.members("scenes");
    if (scenes.empty()) root.fail("a scene", "nodes without one");
    const JsonField& scene = root.has("scene") ? referredBy(root["scene"], scenes) : scenes.front();
    for (const JsonField& node : membersOf(scene, "nodes")) addNode(node, Eigen::Affine3d::Identity(), 0);
  }
  std::vector<SceneMesh>& found() { return found_; }

 private:
  void addNode(const JsonField& reference, const Eigen::Affine3d& parent, int depth) {
    // A tree: no more nodes are met than there are, or some are met twice.
    if (depth > kDeepest || ++met_ > nodes_.size())
      reference.fail("a tree of nodes, 64 deep at the most", "another graph");
    const JsonField& node = referredBy(reference, nodes_);
    const Eigen::Affine3d place = parent * placeOf(node);
    // Bones place a skinned mesh, whatever its node says.
    const bool skinned = node.has("skin");
    if (node.has("mesh"))
      addMesh(referredBy(node["mesh"], meshes_), skinned ? Eigen::Affine3d::Identity() : place, nameOf(node));
    for (const JsonField& child : membersOf(node, "children")) addNode(child, place, depth + 1);
  }

  void addMesh(const JsonField& mesh, const Eigen::Affine3d& place, const std::string& node_name) {
    SceneMesh& made = found_.emplace_back();
    made.name = node_name.empty() ? nameOf(mesh) : node_name;
    const std::vector<JsonField> primitives = mesh["primitives"].elements(1, kMost);
    made.shapes.resize(membersOf(primitives.front(), "targets").size());
    nameShapes(mesh, made);
    for (const JsonField& primitive : primitives) addPrimitive(primitive, place, made);
  }

  /// By mesh.extras.targetNames, where exporters put them.
  static void nameShapes(const JsonField& mesh, SceneMesh& made) {
    if (!mesh.has("extras") || !mesh["extras"].has("targetNames")) return;
    const std::vector<JsonField> names = mesh["extras"]["targetNames"].elements(made.shapes.size(), made.shapes.size());
    for (std::size_t s = 0; s < names.size(); ++s) made.shapes[s].name = names[s].text();
  }

  void addPrimitive(const JsonField& primitive, const Eigen::Affine3d& place, SceneMesh& made) {
    if (primitive.has("mode") && primitive["mode"].integer(0, 6) != kTriangles) {
      primitive["mode"].fail("4: triangles", primitive["mode"].got());
    }
    const JsonField attributes = primitive["attributes"];
    const Accessor& positions = vectorsOf(attributes["POSITION"], 3);
    if (!positions.elements || positions.sparse) attributes["POSITION"].fail("vectors that are stored", "others");
    if ((vertices_ += positions.count) > kMostVertices) {
      attributes["POSITION"].fail(fmt::format("{} vertices in all, at the most", kMostVertices), "more");
    }
    const auto first = static_cast<int>(made.positions.size());
    for (std::size_t i = 0; i < positions.count; ++i) {
      made.positions.emplace_back((place * vectorAt(*positions.elements, i).transpose()).transpose());
    }
    addUvs(attributes, positions.count, made);
    addTargets(primitive, positions.count, place, made);
    const int material =
        primitive.has("material") ? primitive["material"].integer(0, std::max(0, materials_ - 1)) : materials_;
    addTriangles(primitive, positions.count, first, material, place.linear().determinant() < 0.0, made);
  }

  void addUvs(const JsonField& attributes, std::size_t count, SceneMesh& made) const {
    const std::size_t first = made.positions.size() - count;
    if (!attributes.has("TEXCOORD_0")) {
      if (!made.uvs.empty()) attributes.fail("TEXCOORD_0 in all primitives or in none", "some without");
      return;
    }
    const JsonField reference = attributes["TEXCOORD_0"];
    const Accessor& uvs = vectorsOf(reference, 2);
    if (made.uvs.size() != first) reference.fail("TEXCOORD_0 in all primitives or in none", "some without");
    if (uvs.count != count || !uvs.elements || uvs.sparse) reference.fail("as many as positions, stored", "others");
    for (std::size_t i = 0; i < count; ++i) {
      made.uvs.emplace_back(double{uvs.elements->at<float>(i, 0)}, 1.0 - double{uvs.elements->at<float>(i, 1)});
    }
  }

  void addTargets(const JsonField& primitive, std::size_t count, const Eigen::Affine3d& place, SceneMesh& made) {
    const std::vector<JsonField> targets = membersOf(primitive, "targets");
    if (targets.size() != made.shapes.size())
      primitive.fail("as many targets as the mesh's other primitives", "others");
    if (targets.empty()) return;
    if ((offsets_ += targets.size() * count) > kMostOffsets)
      primitive["targets"].fail(fmt::format("{} offsets in all, at the most", kMostOffsets), "more");
    for (std::size_t s = 0; s < targets.size(); ++s) {
      std::vector<Eigen::RowVector3d>& offsets = made.shapes[s].offsets;
      const std::size_t first = offsets.size();
      offsets.resize(first + count, Eigen::RowVector3d::Zero());
      if (!targets[s].has("POSITION")) continue;
      const JsonField reference = targets[s]["POSITION"];
      const Accessor& accessor = vectorsOf(reference, 3);
      if (accessor.count != count) reference.fail("as many as positions", std::to_string(accessor.count));
      const auto put = [&](std::size_t vertex, const Eigen::RowVector3d& offset) {
        offsets[first + vertex] = (place.linear() * offset.transpose()).transpose();
      };
      if (accessor.elements) {
        for (std::size_t i = 0; i < count; ++i) put(i, vectorAt(*accessor.elements, i));
      }
      if (!accessor.sparse) continue;
      for (std::size_t i = 0; i < accessor.sparse->count; ++i) {
        put(accessor.sparse->indices.index(i, accessor.sparse->index_type), vectorAt(accessor.sparse->values, i));
      }
    }
  }

  const Accessor& vectorsOf(const JsonField& reference, int components) const {
    const Accessor& accessor = accessors_.at(reference);
    if (accessor.component_type != kFloat || accessor.components != components)
      reference.fail(fmt::format("vectors of {} floats", components), "others");
    return accessor;
  }

  /// mirrored  placed by a reflection: the other way about is outwards
  void addTriangles(const JsonField& primitive, std::size_t vertices, int first, int material, bool mirrored,
                    SceneMesh& made) {
    std::size_t count = vertices;
    const Accessor* indices = nullptr;
    if (primitive.has("indices")) {
      indices = &accessors_.at(primitive["indices"]);
      if (indices->component_type == kFloat || indices->components != 1 || !indices->elements || indices->sparse) {
        primitive["indices"].fail("whole numbers that are stored", "others");
      }
      count = indices->count;
    }
    if ((triangles_ += count / 3) > kMostVertices) {
      primitive.fail(fmt::format("{} triangles in all, at the most", kMostVertices), "more");
    }
    if (count % 3 != 0) primitive.fail("three corners for each triangle", std::to_string(count));
    const auto vertexAt = [&](std::size_t corner) {
      const std::size_t vertex =
          indices == nullptr ? corner : indices->elements->index(corner, indices->component_type);
      if (vertex >= vertices)
        primitive["indices"].fail(fmt::format("indices below {}", vertices), std::to_string(vertex));
      return first + static_cast<int>(vertex);
    };
    for (std::size_t corner = 0; corner < count; corner += 3) {
      made.polygons.push_back(static_cast<int>(made.triangles.size()));
      made.triangles.emplace_back(vertexAt(corner), vertexAt(corner + (mirrored ? 2 : 1)),
                                  vertexAt(corner + (mirrored ? 1 : 2)));
      made.materials.push_back(material);
    }
  }

  GltfAccessors accessors_;
  std::vector<JsonField> nodes_, meshes_;
  int materials_;
  std::size_t met_ = 0, vertices_ = 0, triangles_ = 0, offsets_ = 0;
  std::vector<SceneMesh> found_;
};

}  // namespace

GlbFile::GlbFile(const fs::path& file, const char* what)
    : name_(file.string()), bytes_(io::readFile(file, what, "", kMostBytes)) {
  const GlbParts parts = splitGlb(std::as_bytes(std::span(bytes_)), name_);
  document_ = io::parseJson(parts.json, name_, kCure);
  const JsonField document = root();
  if (document.has("extensionsRequired")) document["extensionsRequired"].elements(0, 0);
  const JsonField buffer = document["buffers"].elements(1, 1)[0];
  if (buffer.has("uri")) buffer["uri"].fail("none: the buffer is in the file", buffer["uri"].got());
  binary_ = parts.binary.first(toSize(buffer["byteLength"].integer(1, static_cast<int>(parts.binary.size()))));
}

JsonField GlbFile::root() const { return {document_, name_, "", kCure}; }

std::vector<JsonField> GlbFile::members(const char* key) const { return membersOf(root(), key); }

const JsonField& referredBy(const JsonField& reference, const std::vector<JsonField>& among) {
  if (among.empty()) reference.fail("none, as there is nothing to refer to", reference.got());
  return among[toSize(reference.integer(0, static_cast<int>(among.size()) - 1))];
}

std::vector<SceneMesh> meshesOf(const GlbFile& file) {
  SceneReader reader(file);
  std::vector<SceneMesh>& meshes = reader.found();
  std::erase_if(meshes, [](const SceneMesh& mesh) { return mesh.triangles.empty(); });
  if (meshes.empty()) file.root().fail("a mesh of triangles in the scene", "none");
  return std::move(meshes);
}

}  // namespace facezip::scene
