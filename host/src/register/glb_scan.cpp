#include "register/glb_scan.hpp"

#include <fmt/format.h>

#include "facezip/error.hpp"
#include "io/counts.hpp"
#include "io/json_field.hpp"
#include "io/write_file.hpp"
#include "scene/glb_scene.hpp"

namespace facezip::registration {
namespace {
namespace fs = std::filesystem;
using io::JsonField;
using Bytes = std::span<const std::byte>;

Bytes bytesOf(const JsonField& view, Bytes binary) {
  const auto size = static_cast<int>(binary.size());
  const int offset = view.has("byteOffset") ? view["byteOffset"].integer(0, size) : 0;
  return binary.subspan(toSize(offset), toSize(view["byteLength"].integer(1, size - offset)));
}

/// Puts the image of each material's base colour down as a file; empty where a material has none.
std::vector<fs::path> putDownTextures(const scene::GlbFile& glb, std::unique_ptr<io::ScratchDirectory>& folder) {
  const std::vector<JsonField> textures = glb.members("textures"), images = glb.members("images"),
                               views = glb.members("bufferViews");
  std::vector<fs::path> files;
  for (const JsonField& material : glb.members("materials")) {
    fs::path& file = files.emplace_back();
    if (!material.has("pbrMetallicRoughness")) continue;
    const JsonField metallic = material["pbrMetallicRoughness"];
    if (!metallic.has("baseColorTexture")) continue;
    const JsonField colour = metallic["baseColorTexture"];
    if (colour.has("extensions")) colour["extensions"].fail("none: UVs as they stand", colour["extensions"].got());
    if (colour.has("texCoord")) colour["texCoord"].integer(0, 0);
    const JsonField& texture = scene::referredBy(colour["index"], textures);
    const JsonField& image = scene::referredBy(texture["source"], images);
    if (!image.has("bufferView")) image.fail("an image in the file", "one beside it");
    const std::string type = image["mimeType"].text();
    if (type != "image/png" && type != "image/jpeg")
      image["mimeType"].fail("image/png or image/jpeg", image["mimeType"].got());
    if (!folder) folder = std::make_unique<io::ScratchDirectory>();
    file = folder->path() / fmt::format("material_{}{}", files.size(), type == "image/png" ? ".png" : ".jpg");
    const Bytes bytes = bytesOf(scene::referredBy(image["bufferView"], views), glb.binary());
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

geometry::TexturedMesh joinedMeshes(const std::vector<scene::SceneMesh>& meshes, const fs::path& file) {
  std::vector<Eigen::RowVector3d> positions;
  std::vector<Eigen::RowVector2d> uvs;
  std::vector<Eigen::RowVector3i> triangles;
  geometry::TexturedMesh joined;
  for (const scene::SceneMesh& mesh : meshes) {
    if (mesh.uvs.empty()) {
      throw InputError({file.string(), "", "texture coordinates (TEXCOORD_0) in every mesh", "a mesh without",
                        "export the scan with its UVs"});
    }
    const auto first = static_cast<int>(positions.size());
    positions.insert(positions.end(), mesh.positions.begin(), mesh.positions.end());
    uvs.insert(uvs.end(), mesh.uvs.begin(), mesh.uvs.end());
    for (const Eigen::RowVector3i& triangle : mesh.triangles) triangles.emplace_back(triangle.array() + first);
    joined.materials.insert(joined.materials.end(), mesh.materials.begin(), mesh.materials.end());
  }
  joined.mesh.positions = stacked<Eigen::MatrixX3d>(positions);
  joined.mesh.uvs = stacked<Eigen::MatrixX2d>(uvs);
  joined.mesh.triangles = stacked<Eigen::MatrixX3i>(triangles);
  joined.mesh.uv_triangles = joined.mesh.triangles;
  return joined;
}

GlbScan readGlbScan(const fs::path& file) {
  const scene::GlbFile glb(file, "a scan");
  GlbScan scan;
  scan.textured = joinedMeshes(scene::meshesOf(glb), file);
  scan.textured.textures = putDownTextures(glb, scan.pictures);
  return scan;
}

}  // namespace facezip::registration
