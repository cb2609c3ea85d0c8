#include "mesh/gltf_scene.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tiny_gltf.h>

#include <algorithm>
#include <fstream>

#include "facezip/error.hpp"
#include "mesh/gltf_buffer.hpp"
#include "mesh/gltf_tangents.hpp"
#include "small_capture.hpp"
#include "temporary_directory.hpp"

namespace facezip {
namespace {
using mesh::GltfScene;
using testing::ElementsAre;

/// Two triangles of a square; the diagonal is a UV seam. Vertex 4 belongs to no triangle.
geometry::TriangleMesh seamedSquare() {
  geometry::TriangleMesh mesh;
  mesh.positions.resize(5, 3);
  mesh.positions << 0, 0, 0, 100, 0, 0, 100, 100, 0, 0, 100, 0, 7, 7, 7;
  mesh.triangles.resize(2, 3);
  mesh.triangles << 0, 1, 2, 0, 2, 3;
  mesh.uvs.resize(6, 2);
  mesh.uvs << 0, 0, 0.5, 0, 0.5, 1, 0.5, 0, 1, 1, 0.5, 1;
  mesh.uv_triangles.resize(2, 3);
  mesh.uv_triangles << 0, 1, 2, 3, 4, 5;
  return mesh;
}

GltfScene squareScene() {
  GltfScene scene;
  scene.name = "square";
  scene.neutral = seamedSquare();
  scene.metres_per_unit = 0.01;
  scene.base_colour_texture = "albedo/neutral.png";
  scene.material_extras = {{"facezip", {{"version", 1}, {"names", {"a", "b"}}, {"scale", 0.5}}}};
  Eigen::MatrixX3d raised = scene.neutral.positions;
  raised(1, 2) = 50.0;  // one corner: sparse
  scene.targets.push_back({"smile", raised});
  scene.targets.push_back({"still", scene.neutral.positions});
  return scene;
}

tinygltf::Model load(const std::filesystem::path& file) {
  tinygltf::Model model;
  tinygltf::TinyGLTF loader;
  // Textures are referred to, not there.
  loader.SetImageLoader([](tinygltf::Image*, const int, std::string*, std::string*, int, int, const unsigned char*, int,
                           void*) { return true; },
                        nullptr);
  std::string error, warning;
  const bool loaded = file.extension() == ".glb" ? loader.LoadBinaryFromFile(&model, &error, &warning, file.string())
                                                 : loader.LoadASCIIFromFile(&model, &error, &warning, file.string());
  EXPECT_TRUE(loaded) << error;
  return model;
}

TEST(SplitVertices, SplitsAtSeamsAndDropsWhatIsNotUsed) {
  const mesh::SplitVertices split = mesh::splitVertices(seamedSquare().triangles, seamedSquare().uv_triangles);
  EXPECT_THAT(split.positions, ElementsAre(0, 0, 1, 2, 2, 3));
  EXPECT_THAT(split.uvs, ElementsAre(0, 3, 1, 2, 4, 5));
  EXPECT_THAT(split.corners, ElementsAre(0, 2, 3, 1, 4, 5));
}

TEST(VertexNormals, AreOfUnitLengthEvenWithoutTriangles) {
  const geometry::TriangleMesh mesh = seamedSquare();
  const Eigen::MatrixX3d normals = mesh::vertexNormals(mesh.positions, mesh.triangles);
  for (Eigen::Index v = 0; v < 5; ++v) EXPECT_EQ(normals.row(v), Eigen::RowVector3d(0, 0, 1)) << v;
}

TEST(WriteGltf, GivesBackMeshTargetsAndExtras) {
  const test::TemporaryDirectory directory;
  for (const char* name : {"square.gltf", "square.glb"}) {
    const std::filesystem::path file = directory.path() / name;
    // A loader looks for the files that are referred to.
    std::filesystem::create_directories(directory.path() / "albedo");
    std::ofstream(directory.path() / "albedo/neutral.png") << "png";
    mesh::writeGltf(file, squareScene());
    const tinygltf::Model model = load(file);
    ASSERT_EQ(model.meshes.size(), 1u) << name;
    const tinygltf::Primitive& primitive = model.meshes[0].primitives.at(0);
    const tinygltf::Accessor& position = model.accessors[static_cast<std::size_t>(primitive.attributes.at("POSITION"))];
    EXPECT_EQ(position.count, 6u);
    EXPECT_THAT(position.maxValues, ElementsAre(1.0, 1.0, 0.0));  // metres
    ASSERT_EQ(primitive.targets.size(), 2u);
    const auto target = [&](int t, const char* attribute) -> const tinygltf::Accessor& {
      return model.accessors[static_cast<std::size_t>(primitive.targets[static_cast<std::size_t>(t)].at(attribute))];
    };
    EXPECT_TRUE(target(0, "POSITION").sparse.isSparse);
    EXPECT_EQ(target(0, "POSITION").sparse.count, 1);
    EXPECT_THAT(target(0, "POSITION").maxValues, ElementsAre(0.0, 0.0, 0.5));
    EXPECT_EQ(target(1, "POSITION").count, 6u);
    EXPECT_EQ(model.meshes[0].extras.Get("targetNames").Get(1).Get<std::string>(), "still");
    EXPECT_EQ(model.images.at(0).uri, "albedo/neutral.png");
    EXPECT_EQ(model.materials.at(0).extras.Get("facezip").Get("scale").GetNumberAsDouble(), 0.5);
  }
}

/// Far from the origin, floats of metres would be off by 4 mm: a vertex and its neighbours would be one.
TEST(WriteGltf, RecentresWhatFloatsWouldRoundOff) {
  const test::TemporaryDirectory directory;
  GltfScene near = squareScene(), far = near;
  const Eigen::RowVector3d place(300.0, 4'500'000.0, -70.0);
  EXPECT_TRUE(mesh::recentre(near).isZero(0.0));
  far.neutral.positions.rowwise() += place;
  for (mesh::MorphTarget& target : far.targets) target.positions.rowwise() += place;
  const Eigen::RowVector3d origin = mesh::recentre(far);
  EXPECT_LT((origin - place).norm(), 100.0);
  mesh::writeGltf(directory.path() / "near.glb", near);
  mesh::writeGltf(directory.path() / "far.glb", far);
  const tinygltf::Model expected = load(directory.path() / "near.glb"), found = load(directory.path() / "far.glb");
  const auto floats = [](const tinygltf::Model& model, const std::map<std::string, int>& attributes) {
    return mesh::readFloats(model, attributes.at("POSITION"));
  };
  const std::vector<float> at_rest = floats(expected, expected.meshes[0].primitives[0].attributes);
  const std::vector<float> moved = floats(found, found.meshes[0].primitives[0].attributes);
  ASSERT_EQ(moved.size(), at_rest.size());
  for (std::size_t i = 0; i < moved.size(); ++i) {
    const auto axis = static_cast<Eigen::Index>(i % 3);
    EXPECT_NEAR(moved[i], at_rest[i] + 0.01 * (place[axis] - origin[axis]), 1e-6);
    EXPECT_NEAR(found.meshes[0].extras.Get("origin").Get(i % 3).GetNumberAsDouble(), 0.01 * origin[axis], 1e-9);
  }
  EXPECT_EQ(floats(found, found.meshes[0].primitives[0].targets[0]),
            floats(expected, expected.meshes[0].primitives[0].targets[0]));
  EXPECT_FALSE(expected.meshes[0].extras.Has("origin"));
}

/// Tangents run along u, are orthogonal to normals of unit length, and follow the morph targets.
TEST(AddTangents, FollowUvsAndTargets) {
  const test::TemporaryDirectory directory;
  for (const bool mirrored : {false, true}) {
    GltfScene scene = squareScene();
    // A sheet bent around y, whose u runs along the bend.
    scene.neutral = test::gridMesh(9);
    if (mirrored) scene.neutral.uvs.col(0) = 1.0 - scene.neutral.uvs.col(0).array();
    Eigen::MatrixX3d bent = scene.neutral.positions;
    bent.col(2).array() += 2.0 * bent.col(0).array().square();
    scene.targets = {{"bent", bent}, {"still", scene.neutral.positions}};
    scene.base_colour_texture.clear();
    scene.metres_per_unit = 1.0;
    mesh::writeGltf(directory.path() / "a.glb", scene);
    tinygltf::Model model = load(directory.path() / "a.glb");
    EXPECT_FALSE(model.meshes[0].primitives[0].attributes.contains("TANGENT"));
    mesh::addTangents(model);
    const tinygltf::Primitive& primitive = model.meshes[0].primitives[0];
    const std::vector<float> normals = mesh::readFloats(model, primitive.attributes.at("NORMAL"));
    const std::vector<float> tangents = mesh::readFloats(model, primitive.attributes.at("TANGENT"));
    const std::vector<float> turned = mesh::readFloats(model, primitive.targets[0].at("NORMAL"));
    const std::vector<float> changes = mesh::readFloats(model, primitive.targets[0].at("TANGENT"));
    const std::vector<float> none = mesh::readFloats(model, primitive.targets[1].at("TANGENT"));
    EXPECT_EQ(std::ranges::count(none, 0.0f), static_cast<std::ptrdiff_t>(none.size()));
    ASSERT_EQ(tangents.size(), 4u * 81);
    for (std::size_t v = 0; v < 81; ++v) {
      const Eigen::Vector3f n(normals[3 * v], normals[3 * v + 1], normals[3 * v + 2]);
      const Eigen::Vector3f t(tangents[4 * v], tangents[4 * v + 1], tangents[4 * v + 2]);
      const Eigen::Vector3f n2 = n + Eigen::Vector3f(turned[3 * v], turned[3 * v + 1], turned[3 * v + 2]);
      const Eigen::Vector3f t2 = t + Eigen::Vector3f(changes[3 * v], changes[3 * v + 1], changes[3 * v + 2]);
      EXPECT_NEAR(t.norm(), 1.0f, 1e-6f);
      EXPECT_NEAR(t.dot(n), 0.0f, 1e-6f);
      EXPECT_NEAR(t2.dot(n2), 0.0f, 1e-5f) << "follows the target's normal";
      EXPECT_GT(mirrored ? -t[0] : t[0], 0.9f) << "along u";
      EXPECT_EQ(tangents[4 * v + 3], mirrored ? -1.0f : 1.0f) << "bitangent n x t w runs up in the texture";
    }
  }
}

TEST(WriteGltf, RefusesATargetOfAnotherTopology) {
  const test::TemporaryDirectory directory;
  GltfScene scene = squareScene();
  scene.targets[1].positions.conservativeResize(4, 3);
  try {
    mesh::writeGltf(directory.path() / "square.glb", scene);
    FAIL() << "expected InputError";
  } catch (const InputError& error) {
    EXPECT_EQ(error.parts().item, "still");
    EXPECT_EQ(error.parts().expected, "5 vertices as the neutral has");
  }
}

TEST(WriteGltf, SaysWhenItCannotWrite) {
  EXPECT_THROW(mesh::writeGltf("/nonexistent/folder/square.glb", squareScene()), OutputError);
}

}  // namespace
}  // namespace facezip
