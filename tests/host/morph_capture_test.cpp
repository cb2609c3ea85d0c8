// Captures whose meshes are morph targets of one GLB or FBX file.
#include <assimp/scene.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <assimp/Exporter.hpp>
#include <cstring>
#include <nlohmann/json.hpp>

#include "capture/capture_meshes.hpp"
#include "facezip/compress.hpp"
#include "facezip/error.hpp"
#include "facezip/package.hpp"
#include "io/read_file.hpp"
#include "io/write_file.hpp"
#include "mesh/gltf_scene.hpp"
#include "notes.hpp"
#include "register/scan_files.hpp"
#include "scene/glb.hpp"
#include "small_capture.hpp"
#include "temporary_directory.hpp"
#include "test_device.hpp"

namespace facezip {
namespace {
namespace fs = std::filesystem;
using nlohmann::json;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;

/// A patch with a seam: its last column of quads has UVs of its own, so that files split the vertices there.
geometry::TriangleMesh seamedPatch() {
  geometry::TriangleMesh mesh = test::gridMesh(5);
  const Eigen::Index uvs = mesh.uvs.rows();
  mesh.uvs.conservativeResize(2 * uvs, 2);
  mesh.uvs.bottomRows(uvs) = mesh.uvs.topRows(uvs);
  mesh.uvs.bottomRows(uvs).col(0).array() += 0.05;
  for (Eigen::Index t = 0; t < mesh.uv_triangles.rows(); ++t) {
    if (t % 8 >= 6) mesh.uv_triangles.row(t).array() += static_cast<int>(uvs);
  }
  return mesh;
}

Eigen::MatrixX3d smiling(const geometry::TriangleMesh& mesh) {
  Eigen::MatrixX3d positions = mesh.positions;
  positions.row(7) += Eigen::RowVector3d(0.25, 0.5, -0.125);
  return positions;
}

/// Where a corner of a triangle lies does not depend on how a file numbers its vertices.
void expectSameCorners(const geometry::TriangleMesh& topology, const Eigen::MatrixX3d& got,
                       const geometry::TriangleMesh& like, const Eigen::MatrixX3d& expected) {
  ASSERT_EQ(topology.triangles.rows(), like.triangles.rows());
  for (Eigen::Index t = 0; t < like.triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) {
      EXPECT_LT((got.row(topology.triangles(t, k)) - expected.row(like.triangles(t, k))).norm(), 1e-6) << t;
      EXPECT_LT((topology.uvs.row(topology.uv_triangles(t, k)) - like.uvs.row(like.uv_triangles(t, k))).norm(), 1e-6);
    }
  }
}

class MorphCapture : public testing::Test {
 protected:
  MorphCapture() : patch_(seamedPatch()) {
    test::writeSmallCapture(folder_ / "face", {.expressions = 2, .width = 16, .height = 16});
    fs::remove(capture() / "neutral.obj");
    fs::remove_all(capture() / "expressions");
  }
  fs::path capture() const { return folder_ / "face"; }

  void writeGlb(const fs::path& file, const std::vector<std::string>& names) const {
    mesh::GltfScene scene;
    scene.name = "head";
    scene.neutral = patch_;
    for (const std::string& name : names) scene.targets.push_back({name, smiling(patch_)});
    mesh::writeGltf(file, scene);
  }
  /// Changes the document of a GLB file.
  template <typename Change>
  void edit(const fs::path& file, const Change& change) const {
    const std::string bytes = io::readFile(file, "a mesh");
    const scene::GlbParts parts = scene::splitGlb(std::as_bytes(std::span(bytes)), "good");
    json document = json::parse(parts.json);
    change(document);
    io::writeTextFile(file, scene::joinGlb(document.dump(), parts.binary));
  }
  std::string failure() const {
    try {
      openCapture(capture());
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  }

  const test::TemporaryDirectory folder_;
  const geometry::TriangleMesh patch_;
};

TEST_F(MorphCapture, ExpressionsAreTheTargetsOfTheirNames) {
  writeGlb(capture() / "head.glb", {"head_mesh__e01", "head_mesh__yawn"});
  test::Notes notes;
  const Capture opened = openCapture(capture(), {}, &notes);
  EXPECT_EQ(opened.neutral_mesh, capture() / "head.glb");
  ASSERT_EQ(opened.expression_meshes.size(), 2u);
  EXPECT_EQ(opened.expression_meshes[0], "");
  EXPECT_EQ(opened.expression_meshes[1], capture() / "head.glb");
  EXPECT_THAT(notes.all, Contains(HasSubstr("yawn matches no expression")));
  EXPECT_THAT(notes.all, Contains(HasSubstr("no mesh for e00")));
  const CaptureMeshes meshes(opened);
  EXPECT_EQ(meshes.neutral().positions.rows(), 25) << "seams are closed";
  expectSameCorners(meshes.neutral(), meshes.neutral().positions, patch_, patch_.positions);
  expectSameCorners(meshes.neutral(), meshes.positions(1), patch_, smiling(patch_));
}

TEST_F(MorphCapture, LipsThatTouchAndPartStayApart) {
  geometry::TriangleMesh lips;
  lips.positions.resize(6, 3);
  lips.positions << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, -1, 0;
  lips.uvs.resize(6, 2);
  lips.uvs << 0, 0, 1, 0, 0, 1, 0.1, 0.1, 0.9, 0.1, 0.5, 0.5;
  lips.triangles.resize(2, 3);
  lips.triangles << 0, 1, 2, 4, 3, 5;
  lips.uv_triangles = lips.triangles;
  mesh::GltfScene scene;
  scene.neutral = lips;
  Eigen::MatrixX3d open = lips.positions;
  open.row(4) += Eigen::RowVector3d(0, -0.5, 0);
  scene.targets = {{"e00", open}, {"e01", open}};
  mesh::writeGltf(capture() / "lips.glb", scene);
  const CaptureMeshes meshes(openCapture(capture()));
  EXPECT_EQ(meshes.neutral().positions.rows(), 5) << "the corner is one vertex, the lips are two";
}

TEST_F(MorphCapture, NodesBonesAndAnimationsAreNoObstacle) {
  writeGlb(capture() / "head.glb", {"e00", "e01"});
  edit(capture() / "head.glb", [](json& d) {
    d["nodes"] = json::array({{{"children", {1}}, {"scale", {2, 2, 2}}}, {{"mesh", 0}, {"translation", {0, 1, 0}}}});
    d["scenes"] = json::array({{{"nodes", {0}}}});
    d["accessors"].push_back({{"type", "MAT4"}, {"componentType", 5126}, {"count", 3}});
  });
  const CaptureMeshes meshes(openCapture(capture()));
  Eigen::MatrixX3d placed = 2.0 * (smiling(patch_).rowwise() + Eigen::RowVector3d(0, 1, 0));
  expectSameCorners(meshes.neutral(), meshes.positions(0), patch_, placed);
}

TEST_F(MorphCapture, WhatCannotBeMeantIsRefused) {
  EXPECT_THAT(failure(), HasSubstr("neutral.obj"));
  writeGlb(capture() / "head.glb", {"e00", "e01"});
  writeGlb(capture() / "other.glb", {"e00", "e01"});
  EXPECT_THAT(failure(), HasSubstr("head.glb and other.glb"));
  io::writeTextFile(capture() / "capture.json", R"({"neutral_mesh": "other.glb", "mesh": "teeth"})");
  EXPECT_THAT(failure(), AllOf(HasSubstr("one of \"head\""), HasSubstr("teeth")));
  io::writeTextFile(capture() / "capture.json", R"({"neutral_mesh": "other.glb"})");
  EXPECT_EQ(failure(), "no error");
  writeGlb(capture() / "other.glb", {"e00", "e00"});
  EXPECT_THAT(failure(), HasSubstr("\"e00\" twice"));
  writeGlb(capture() / "other.glb", {"e00", "e01"});
  edit(capture() / "other.glb", [](json& d) { d["meshes"][0].erase("extras"); });
  EXPECT_THAT(failure(), HasSubstr("targetNames"));
  io::writeTextFile(capture() / "capture.json", R"({"neutral_mesh": "other.fbx"})");
  io::writeTextFile(capture() / "other.fbx", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_THAT(failure(), AllOf(HasSubstr("other.fbx"), HasSubstr("an FBX file")));
}

TEST_F(MorphCapture, IsCompressedAsOneOfObjFiles) {
  writeGlb(capture() / "head.glb", {"e00", "e01"});
  Progress progress;
  CompressOptions options;
  options.masks = 3;
  options.unit = "m";
  compressCapture(openCapture(capture()), folder_ / "morphs.facezip", options, test::testDevice(), progress);
  fs::remove(capture() / "head.glb");
  geometry::writeObj(capture() / "neutral.obj", patch_);
  fs::create_directory(capture() / "expressions");
  geometry::TriangleMesh smile = patch_;
  smile.positions = smiling(patch_);
  for (const char* name : {"e00.obj", "e01.obj"}) geometry::writeObj(capture() / "expressions" / name, smile);
  compressCapture(openCapture(capture()), folder_ / "objs.facezip", options, test::testDevice(), progress);
  for (const char* file : {"mesh.glb", "albedo/neutral.png", "albedo/difference_0.png"}) {
    EXPECT_EQ(fs::file_size(folder_ / "morphs.facezip" / file), fs::file_size(folder_ / "objs.facezip" / file)) << file;
  }
}

/// The patch as assimp exports it, as text (its binary files end blocks as its reader does not expect).
void writeFbx(const fs::path& file, const geometry::TriangleMesh& patch, const std::vector<std::string>& names) {
  const auto triangles = static_cast<unsigned>(patch.triangles.rows());
  auto* mesh = new aiMesh;  // owned by the scene
  mesh->mName = "head";
  mesh->mPrimitiveTypes = aiPrimitiveType_TRIANGLE;
  mesh->mNumVertices = 3 * triangles;
  mesh->mVertices = new aiVector3D[mesh->mNumVertices];
  mesh->mNormals = new aiVector3D[mesh->mNumVertices];
  mesh->mTextureCoords[0] = new aiVector3D[mesh->mNumVertices];
  mesh->mNumUVComponents[0] = 2;
  mesh->mNumFaces = triangles;
  mesh->mFaces = new aiFace[triangles];
  mesh->mNumAnimMeshes = static_cast<unsigned>(names.size());
  mesh->mAnimMeshes = new aiAnimMesh*[names.size()];
  const auto vector = [](const Eigen::MatrixX3d& rows, int row) {
    return aiVector3D(static_cast<float>(rows(row, 0)), static_cast<float>(rows(row, 1)),
                      static_cast<float>(rows(row, 2)));
  };
  for (std::size_t s = 0; s < names.size(); ++s) {
    mesh->mAnimMeshes[s] = new aiAnimMesh;
    mesh->mAnimMeshes[s]->mName = names[s];
    mesh->mAnimMeshes[s]->mNumVertices = mesh->mNumVertices;
    mesh->mAnimMeshes[s]->mVertices = new aiVector3D[mesh->mNumVertices];
    mesh->mAnimMeshes[s]->mNormals = new aiVector3D[mesh->mNumVertices];
  }
  const Eigen::MatrixX3d smile = smiling(patch);
  for (unsigned t = 0; t < triangles; ++t) {
    mesh->mFaces[t].mNumIndices = 3;
    mesh->mFaces[t].mIndices = new unsigned[3];
    for (unsigned k = 0; k < 3; ++k) {
      const unsigned corner = 3 * t + k;
      mesh->mFaces[t].mIndices[k] = corner;
      const int vertex = patch.triangles(t, k), uv = patch.uv_triangles(t, k);
      mesh->mVertices[corner] = vector(patch.positions, vertex);
      mesh->mNormals[corner] = aiVector3D(0, 0, 1);
      mesh->mTextureCoords[0][corner] =
          aiVector3D(static_cast<float>(patch.uvs(uv, 0)), static_cast<float>(patch.uvs(uv, 1)), 0);
      for (std::size_t s = 0; s < names.size(); ++s) {
        mesh->mAnimMeshes[s]->mVertices[corner] = vector(smile, vertex);
        mesh->mAnimMeshes[s]->mNormals[corner] = aiVector3D(0, 0, 1);
      }
    }
  }
  aiScene scene;
  scene.mNumMeshes = 1;
  scene.mMeshes = new aiMesh* [1] { mesh };
  scene.mNumMaterials = 1;
  scene.mMaterials = new aiMaterial* [1] { new aiMaterial };
  scene.mRootNode = new aiNode("root");
  auto* node = new aiNode("head");
  node->mNumMeshes = 1;
  node->mMeshes = new unsigned[1]{0};
  scene.mRootNode->addChildren(1, &node);
  Assimp::Exporter exporter;
  ASSERT_EQ(exporter.Export(&scene, "fbxa", file.string()), aiReturn_SUCCESS) << exporter.GetErrorString();
}

TEST_F(MorphCapture, FbxIsReadToo) {
  writeFbx(capture() / "head.fbx", patch_, {"e00", "e01"});
  const Capture opened = openCapture(capture());
  EXPECT_EQ(opened.expression_meshes[1], capture() / "head.fbx");
  const CaptureMeshes meshes(opened);
  EXPECT_EQ(meshes.neutral().positions.rows(), 25);
  expectSameCorners(meshes.neutral(), meshes.positions(1), patch_, smiling(patch_));
  fs::copy_file(capture() / "albedo/neutral.png",
                capture() / "head.png");  // as a scan, textured by the image beside it
  const registration::Scan scan = registration::readScan(capture() / "head.fbx");
  EXPECT_EQ(scan.mesh.positions.rows(), 25);
  EXPECT_EQ(scan.textures.at(0), capture() / "head.png");
  fs::remove(capture() / "head.png");
  const std::string whole = io::readFile(capture() / "head.fbx", "a mesh");
  for (const double share : {0.0, 0.01, 0.3, 0.6, 0.9}) {
    io::writeTextFile(capture() / "head.fbx",
                      whole.substr(0, static_cast<std::size_t>(share * static_cast<double>(whole.size()))));
    const std::string said = failure();
    EXPECT_TRUE(said == "no error" || said.find("head.fbx") != std::string::npos) << share << said;
  }
}

}  // namespace
}  // namespace facezip
