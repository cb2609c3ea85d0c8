#include "export/gltf_scene.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tiny_gltf.h>

#include <fstream>

#include "facezip/error.hpp"
#include "temporary_directory.hpp"

namespace facezip {
namespace {
using exporting::GltfScene;
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
  const exporting::SplitVertices split = exporting::splitVertices(seamedSquare());
  EXPECT_THAT(split.positions, ElementsAre(0, 0, 1, 2, 2, 3));
  EXPECT_THAT(split.uvs, ElementsAre(0, 3, 1, 2, 4, 5));
  EXPECT_THAT(split.corners, ElementsAre(0, 2, 3, 1, 4, 5));
}

TEST(VertexNormals, AreOfUnitLengthEvenWithoutTriangles) {
  const geometry::TriangleMesh mesh = seamedSquare();
  const Eigen::MatrixX3d normals = exporting::vertexNormals(mesh.positions, mesh.triangles);
  for (Eigen::Index v = 0; v < 5; ++v) EXPECT_EQ(normals.row(v), Eigen::RowVector3d(0, 0, 1)) << v;
}

TEST(WriteGltf, GivesBackMeshTargetsAndExtras) {
  const test::TemporaryDirectory directory;
  for (const char* name : {"square.gltf", "square.glb"}) {
    const std::filesystem::path file = directory.path() / name;
    // A loader looks for the files that are referred to.
    std::filesystem::create_directories(directory.path() / "albedo");
    std::ofstream(directory.path() / "albedo/neutral.png") << "png";
    exporting::writeGltf(file, squareScene());
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

TEST(WriteGltf, RefusesATargetOfAnotherTopology) {
  const test::TemporaryDirectory directory;
  GltfScene scene = squareScene();
  scene.targets[1].positions.conservativeResize(4, 3);
  try {
    exporting::writeGltf(directory.path() / "square.glb", scene);
    FAIL() << "expected InputError";
  } catch (const InputError& error) {
    EXPECT_EQ(error.parts().item, "still");
    EXPECT_EQ(error.parts().expected, "5 vertices as the neutral has");
  }
}

TEST(WriteGltf, SaysWhenItCannotWrite) {
  EXPECT_THROW(exporting::writeGltf("/nonexistent/folder/square.glb", squareScene()), OutputError);
}

}  // namespace
}  // namespace facezip
