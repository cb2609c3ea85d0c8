#include "register/glb_scan.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <optional>

#include "io/counts.hpp"
#include "io/json_field.hpp"
#include "io/read_file.hpp"
#include "io/write_file.hpp"
#include "mesh/glb.hpp"
#include "mesh/gltf_accessors.hpp"

namespace facezip::registration {
namespace {
namespace fs = std::filesystem;
using io::JsonField;
using mesh::Accessor;
using mesh::GltfAccessors;
using Bytes = std::span<const std::byte>;

constexpr std::uintmax_t kMostBytes = std::uintmax_t{2} << 30;
constexpr std::size_t kMost = 65536;  // nodes, meshes, materials, images
constexpr int kDeepest = 64;
constexpr std::size_t kMostVertices = std::size_t{1} << 25;  // nodes may place one mesh many times
constexpr int kTriangles = 4;
constexpr double kFarthest = 1e12;  // of anything that a node says
constexpr const char* kCure = "export the scan as plain glTF 2.0, binary, images inside, without compression";

std::vector<JsonField> membersOf(const JsonField& root, const char* key) {
  return root.has(key) ? root[key].elements(0, kMost) : std::vector<JsonField>();
}

const JsonField& referredBy(const JsonField& reference, const std::vector<JsonField>& among) {
  if (among.empty()) reference.fail("none, as there is nothing to refer to", reference.got());
  return among[toSize(reference.integer(0, static_cast<int>(among.size()) - 1))];
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

/// Vertices and triangles, as they are read.
struct Gathered {
  std::vector<Eigen::RowVector3d> positions;
  std::vector<Eigen::RowVector2d> uvs;
  std::vector<Eigen::RowVector3i> triangles;
  std::vector<int> materials;
};

class Reader {
 public:
  Reader(const JsonField& root, Bytes binary)
      : accessors_(root, binary),
        nodes_(membersOf(root, "nodes")),
        meshes_(membersOf(root, "meshes")),
        materials_(static_cast<int>(membersOf(root, "materials").size())) {
    // Without a scene, every mesh where it lies.
    if (nodes_.empty()) {
      for (const JsonField& mesh : meshes_) addMesh(mesh, Eigen::Affine3d::Identity());
      return;
    }
    const std::vector<JsonField> scenes = membersOf(root, "scenes");
    if (scenes.empty()) root.fail("a scene", "nodes without one");
    const JsonField& scene = root.has("scene") ? referredBy(root["scene"], scenes) : scenes.front();
    for (const JsonField& node : membersOf(scene, "nodes")) addNode(node, Eigen::Affine3d::Identity(), 0);
  }
  Gathered& gathered() { return gathered_; }

 private:
  void addNode(const JsonField& reference, const Eigen::Affine3d& parent, int depth) {
    // A tree: no more nodes are met than there are, or some are met twice.
    if (depth > kDeepest || ++met_ > nodes_.size())
      reference.fail("a tree of nodes, 64 deep at the most", "another graph");
    const JsonField& node = referredBy(reference, nodes_);
    const Eigen::Affine3d place = parent * placeOf(node);
    if (node.has("mesh")) addMesh(referredBy(node["mesh"], meshes_), place);
    for (const JsonField& child : membersOf(node, "children")) addNode(child, place, depth + 1);
  }

  void addMesh(const JsonField& mesh, const Eigen::Affine3d& place) {
    for (const JsonField& primitive : mesh["primitives"].elements(1, kMost)) addPrimitive(primitive, place);
  }

  void addPrimitive(const JsonField& primitive, const Eigen::Affine3d& place) {
    if (primitive.has("mode") && primitive["mode"].integer(0, 6) != kTriangles) {
      primitive["mode"].fail("4: triangles", primitive["mode"].got());
    }
    const JsonField attributes = primitive["attributes"];
    const Accessor& positions = vectorsOf(attributes["POSITION"], 3);
    const Accessor& uvs = vectorsOf(attributes["TEXCOORD_0"], 2);
    if (uvs.count != positions.count) attributes["TEXCOORD_0"].fail("as many as positions", std::to_string(uvs.count));
    if (gathered_.positions.size() + positions.count > kMostVertices) {
      attributes["POSITION"].fail(fmt::format("{} vertices in all, at the most", kMostVertices), "more");
    }
    const auto first = static_cast<int>(gathered_.positions.size());
    for (std::size_t i = 0; i < positions.count; ++i) {
      const Eigen::Vector3d p(positions.elements->at<float>(i, 0), positions.elements->at<float>(i, 1),
                              positions.elements->at<float>(i, 2));
      gathered_.positions.push_back((place * p).transpose());
      gathered_.uvs.emplace_back(double{uvs.elements->at<float>(i, 0)}, 1.0 - double{uvs.elements->at<float>(i, 1)});
    }
    const int material =
        primitive.has("material") ? primitive["material"].integer(0, std::max(0, materials_ - 1)) : materials_;
    addTriangles(primitive, positions.count, first, material, place.linear().determinant() < 0.0);
  }

  const Accessor& vectorsOf(const JsonField& reference, int components) const {
    const Accessor& accessor = accessors_.at(reference);
    if (accessor.component_type != mesh::kFloat || accessor.components != components || !accessor.elements ||
        accessor.sparse) {
      reference.fail(fmt::format("vectors of {} floats that are stored", components), "others");
    }
    return accessor;
  }

  /// mirrored  placed by a reflection: the other way about is outwards
  void addTriangles(const JsonField& primitive, std::size_t vertices, int first, int material, bool mirrored) {
    std::size_t count = vertices;
    const Accessor* indices = nullptr;
    if (primitive.has("indices")) {
      indices = &accessors_.at(primitive["indices"]);
      if (indices->component_type == mesh::kFloat || indices->components != 1 || !indices->elements ||
          indices->sparse) {
        primitive["indices"].fail("whole numbers that are stored", "others");
      }
      count = indices->count;
    }
    if (gathered_.triangles.size() + count / 3 > kMostVertices) {
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
      gathered_.triangles.emplace_back(vertexAt(corner), vertexAt(corner + (mirrored ? 2 : 1)),
                                       vertexAt(corner + (mirrored ? 1 : 2)));
      gathered_.materials.push_back(material);
    }
  }

  GltfAccessors accessors_;
  std::vector<JsonField> nodes_, meshes_;
  int materials_;
  std::size_t met_ = 0;
  Gathered gathered_;
};

Bytes bytesOf(const JsonField& view, Bytes binary) {
  const auto size = static_cast<int>(binary.size());
  const int offset = view.has("byteOffset") ? view["byteOffset"].integer(0, size) : 0;
  return binary.subspan(toSize(offset), toSize(view["byteLength"].integer(1, size - offset)));
}

/// Puts the image of each material's base colour down as a file; empty where a material has none.
std::vector<fs::path> putDownTextures(const JsonField& root, Bytes binary,
                                      std::unique_ptr<io::ScratchDirectory>& folder) {
  const std::vector<JsonField> textures = membersOf(root, "textures"), images = membersOf(root, "images"),
                               views = membersOf(root, "bufferViews");
  std::vector<fs::path> files;
  for (const JsonField& material : membersOf(root, "materials")) {
    fs::path& file = files.emplace_back();
    if (!material.has("pbrMetallicRoughness")) continue;
    const JsonField metallic = material["pbrMetallicRoughness"];
    if (!metallic.has("baseColorTexture")) continue;
    const JsonField colour = metallic["baseColorTexture"];
    if (colour.has("extensions")) colour["extensions"].fail("none: UVs as they stand", colour["extensions"].got());
    if (colour.has("texCoord")) colour["texCoord"].integer(0, 0);
    const JsonField& texture = referredBy(colour["index"], textures);
    const JsonField& image = referredBy(texture["source"], images);
    if (!image.has("bufferView")) image.fail("an image in the file", "one beside it");
    const std::string type = image["mimeType"].text();
    if (type != "image/png" && type != "image/jpeg")
      image["mimeType"].fail("image/png or image/jpeg", image["mimeType"].got());
    if (!folder) folder = std::make_unique<io::ScratchDirectory>();
    file = folder->path() / fmt::format("material_{}{}", files.size(), type == "image/png" ? ".png" : ".jpg");
    const Bytes bytes = bytesOf(referredBy(image["bufferView"], views), binary);
    io::writeTextFile(file, std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  }
  files.emplace_back();
  return files;
}

template <typename Matrix, typename Row>
Matrix stacked(const std::vector<Row>& rows) {
  Matrix matrix(static_cast<Eigen::Index>(rows.size()), Row::ColsAtCompileTime);
  for (std::size_t i = 0; i < rows.size(); ++i) matrix.row(static_cast<Eigen::Index>(i)) = rows[i];
  return matrix;
}

}  // namespace

GlbScan readGlbScan(const fs::path& file) {
  const std::string bytes = io::readFile(file, "a scan", "", kMostBytes);
  const std::string name = file.string();
  const mesh::GlbParts parts = mesh::splitGlb(std::as_bytes(std::span(bytes)), name);
  const nlohmann::json document = io::parseJson(parts.json, name, kCure);
  const JsonField root(document, name, "", kCure);
  if (root.has("extensionsRequired")) root["extensionsRequired"].elements(0, 0);
  const JsonField buffer = root["buffers"].elements(1, 1)[0];
  if (buffer.has("uri")) buffer["uri"].fail("none: the buffer is in the file", buffer["uri"].got());
  const Bytes binary =
      parts.binary.first(toSize(buffer["byteLength"].integer(1, static_cast<int>(parts.binary.size()))));
  Reader reader(root, binary);
  Gathered& gathered = reader.gathered();
  if (gathered.triangles.empty()) root.fail("a mesh of triangles in the scene", "none");
  GlbScan scan;
  scan.textured.mesh.positions = stacked<Eigen::MatrixX3d>(gathered.positions);
  scan.textured.mesh.uvs = stacked<Eigen::MatrixX2d>(gathered.uvs);
  scan.textured.mesh.triangles = stacked<Eigen::MatrixX3i>(gathered.triangles);
  scan.textured.mesh.uv_triangles = scan.textured.mesh.triangles;
  scan.textured.materials = std::move(gathered.materials);
  scan.textured.textures = putDownTextures(root, binary, scan.pictures);
  return scan;
}

}  // namespace facezip::registration
