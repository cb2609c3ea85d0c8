// assimp_fbx.cpp - FBX through assimp, of which every other importer is taken out: a file is FBX, whatever it begins
// with.
#include <assimp/BaseImporter.h>
#include <assimp/config.h>
#include <assimp/importerdesc.h>
#include <assimp/scene.h>

#include <Eigen/Geometry>
#include <assimp/Importer.hpp>
#include <cmath>
#include <string_view>

#include "facezip/error.hpp"
#include "scene/fbx_scene.hpp"

namespace facezip::scene {
namespace {

constexpr int kDeepest = 256;
constexpr const char* kCure = "export the meshes as GLB or OBJ, or as binary FBX 7.4";

[[noreturn]] void refuse(const std::string& file, const std::string& expected, const std::string& got) {
  throw InputError({file, "", expected, got, kCure});
}

void keepFbxAlone(Assimp::Importer& importer) {
  for (std::size_t i = importer.GetImporterCount(); i-- > 0;) {
    const aiImporterDesc* const about = importer.GetImporterInfo(i);
    if (about == nullptr || std::string_view(about->mFileExtensions) != "fbx")
      importer.UnregisterLoader(importer.GetImporter(i));
  }
}

Eigen::Affine3d placeOf(const aiMatrix4x4& m) {
  Eigen::Affine3d place;
  place.matrix() << double{m.a1}, double{m.a2}, double{m.a3}, double{m.a4}, double{m.b1}, double{m.b2}, double{m.b3},
      double{m.b4}, double{m.c1}, double{m.c2}, double{m.c3}, double{m.c4}, 0.0, 0.0, 0.0, 1.0;
  return place;
}

class FbxScene {
 public:
  FbxScene(const aiScene& scene, const std::string& file) : scene_(scene), file_(file) {
    add(*scene.mRootNode, Eigen::Affine3d::Identity(), 0);
    if (found_.empty()) refuse(file_, "a mesh", "none");
  }
  std::vector<SceneMesh>& found() { return found_; }

 private:
  void add(const aiNode& node, const Eigen::Affine3d& parent, int depth) {
    if (depth > kDeepest) refuse(file_, "nodes 256 deep at the most", "deeper ones");
    const Eigen::Affine3d place = parent * placeOf(node.mTransformation);
    for (unsigned m = 0; m < node.mNumMeshes; ++m) addMesh(*scene_.mMeshes[node.mMeshes[m]], place, node.mName.C_Str());
    for (unsigned c = 0; c < node.mNumChildren; ++c) add(*node.mChildren[c], place, depth + 1);
  }

  Eigen::RowVector3d placed(const aiVector3D& point, const Eigen::Affine3d& place) const {
    const Eigen::Vector3d at = place * Eigen::Vector3d(double{point.x}, double{point.y}, double{point.z});
    if (!at.allFinite()) refuse(file_, "finite positions", "others");
    return at.transpose();
  }

  void addMesh(const aiMesh& mesh, const Eigen::Affine3d& place, const std::string& name) {
    if (mesh.mNumVertices == 0 || mesh.mNumFaces == 0) return;
    if ((vertices_ += mesh.mNumVertices) > kMostVertices) refuse(file_, "33554432 vertices at the most", "more");
    if ((offsets_ += std::size_t{mesh.mNumVertices} * mesh.mNumAnimMeshes) > kMostOffsets)
      refuse(file_, "67108864 offsets of blend shapes at the most", "more");
    SceneMesh made;
    made.name = name.empty() ? mesh.mName.C_Str() : name;
    for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
      made.positions.push_back(placed(mesh.mVertices[v], place));
      if (!mesh.HasTextureCoords(0)) continue;
      const aiVector3D& uv = mesh.mTextureCoords[0][v];
      if (!std::isfinite(uv.x) || !std::isfinite(uv.y)) refuse(file_, "finite UVs", "others");
      made.uvs.emplace_back(double{uv.x}, double{uv.y});
    }
    addFaces(mesh, place.linear().determinant() < 0.0, made);
    addShapes(mesh, place, made);
    if (!made.triangles.empty()) found_.push_back(std::move(made));
  }

  /// Polygons as fans, as OBJ files have them.
  void addFaces(const aiMesh& mesh, bool mirrored, SceneMesh& made) {
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      const aiFace& face = mesh.mFaces[f];
      for (unsigned k = 1; k + 1 < face.mNumIndices; ++k) {
        if (++triangles_ > kMostVertices) refuse(file_, "33554432 triangles at the most", "more");
        const unsigned corners[] = {face.mIndices[0], face.mIndices[mirrored ? k + 1 : k],
                                    face.mIndices[mirrored ? k : k + 1]};
        for (const unsigned corner : corners) {
          if (corner >= mesh.mNumVertices) refuse(file_, "corners of the mesh's vertices", "others");
        }
        made.triangles.emplace_back(static_cast<int>(corners[0]), static_cast<int>(corners[1]),
                                    static_cast<int>(corners[2]));
        made.polygons.push_back(static_cast<int>(f));
        made.materials.push_back(static_cast<int>(mesh.mMaterialIndex));
      }
    }
  }

  void addShapes(const aiMesh& mesh, const Eigen::Affine3d& place, SceneMesh& made) const {
    for (unsigned s = 0; s < mesh.mNumAnimMeshes; ++s) {
      const aiAnimMesh& shape = *mesh.mAnimMeshes[s];
      if (shape.mVertices == nullptr || shape.mNumVertices != mesh.mNumVertices) continue;
      SceneShape& made_shape = made.shapes.emplace_back();
      made_shape.name = shape.mName.C_Str();
      for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
        made_shape.offsets.push_back(placed(shape.mVertices[v], place) - made.positions[v]);
      }
    }
  }

  const aiScene& scene_;
  const std::string& file_;
  std::size_t vertices_ = 0, triangles_ = 0, offsets_ = 0;
  std::vector<SceneMesh> found_;
};

std::vector<SceneMesh> read(const std::string& bytes, const std::string& file) {
  Assimp::Importer importer;
  keepFbxAlone(importer);
  importer.SetPropertyBool(AI_CONFIG_IMPORT_FBX_PRESERVE_PIVOTS, false);
  importer.SetPropertyBool(AI_CONFIG_IMPORT_FBX_READ_ANIMATIONS, false);
  importer.SetPropertyBool(AI_CONFIG_IMPORT_FBX_READ_CAMERAS, false);
  importer.SetPropertyBool(AI_CONFIG_IMPORT_FBX_READ_LIGHTS, false);
  const aiScene* const scene = importer.ReadFileFromMemory(bytes.data(), bytes.size(), 0, "fbx");
  if (scene == nullptr || scene->mRootNode == nullptr) {
    std::string reason = importer.GetErrorString();
    refuse(file, "an FBX file", reason.empty() ? "another" : reason.substr(0, 200));
  }
  return std::move(FbxScene(*scene, file).found());
}

}  // namespace

FbxFunction facezipAssimpFbx() { return &read; }

}  // namespace facezip::scene
