#include "register/glb_scan.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <functional>
#include <nlohmann/json.hpp>

#include "facezip/error.hpp"
#include "io/read_file.hpp"
#include "io/write_file.hpp"
#include "register/scan_files.hpp"
#include "scene/glb.hpp"
#include "small_capture.hpp"
#include "temporary_directory.hpp"

namespace facezip {
namespace {
namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;

/// A patch as a GLB with its texture inside, that tests break.
class GlbScan : public testing::Test {
 protected:
  GlbScan() : patch_(test::gridMesh(5)) {
    image::writeImage(folder_ / "skin.png",
                      test::makeImage({8, 8, 3, image::SampleType::kUint8}, [](int x, int, int) { return 20.0 * x; }));
    const std::string picture = io::readFile(folder_ / "skin.png", "an image");
    const auto positions =
        append<float>(25 * 3, [&](int i) { return static_cast<float>(patch_.positions(i / 3, i % 3)); });
    const auto uvs = append<float>(25 * 2, [&](int i) {
      const double value = patch_.uvs(i / 2, i % 2);
      return static_cast<float>(i % 2 == 0 ? value : 1.0 - value);
    });
    const auto indices = append<std::uint16_t>(
        32 * 3, [&](int i) { return static_cast<std::uint16_t>(patch_.triangles(i / 3, i % 3)); });
    const std::size_t image = binary_.size();
    for (const char c : picture) binary_.push_back(static_cast<std::byte>(c));
    while (binary_.size() % 4 != 0) binary_.push_back(std::byte{0});
    document_ = json::parse(R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
      "nodes": [{"children": [1], "translation": [1, 2, 3], "scale": [2, 2, 2]}, {"mesh": 0, "rotation": [0, 0, 0.70710678, 0.70710678]}],
      "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "indices": 2, "material": 0}]}],
      "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
      "textures": [{"source": 0}], "images": [{"bufferView": 3, "mimeType": "image/png"}],
      "accessors": [{"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 25},
        {"bufferView": 1, "componentType": 5126, "type": "VEC2", "count": 25},
        {"bufferView": 2, "componentType": 5123, "type": "SCALAR", "count": 96}]})");
    const auto view = [](std::size_t offset, std::size_t length) {
      return json{{"buffer", 0}, {"byteOffset", offset}, {"byteLength", length}};
    };
    document_["bufferViews"] = {view(positions, 300), view(uvs, 200), view(indices, 192), view(image, picture.size())};
    document_["buffers"] = json::array({{{"byteLength", binary_.size()}}});
  }

  template <typename Number>
  std::size_t append(int count, const std::function<Number(int)>& value) {
    const std::size_t begin = binary_.size();
    for (int i = 0; i < count; ++i) {
      const Number number = value(i);
      std::byte bytes[sizeof(Number)];
      std::memcpy(bytes, &number, sizeof(Number));
      binary_.insert(binary_.end(), bytes, bytes + sizeof(Number));
    }
    return begin;
  }
  fs::path write(const std::string& name = "face.glb") const {
    io::writeTextFile(folder_ / name, scene::joinGlb(document_.dump(), binary_));
    return folder_ / name;
  }
  void expectRefused(const std::string& part) const {
    try {
      registration::readGlbScan(write());
      ADD_FAILURE() << "read what should be refused: " << part;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr(part));
      EXPECT_THAT(error.what(), HasSubstr("face.glb"));
    }
  }

  const test::TemporaryDirectory folder_;
  geometry::TriangleMesh patch_;
  std::vector<std::byte> binary_;
  json document_;
};

TEST_F(GlbScan, IsReadWithNodesTexturesAndUvsUpwards) {
  const registration::Scan scan = registration::readScan(write());
  ASSERT_EQ(scan.mesh.positions.rows(), 25);
  ASSERT_EQ(scan.mesh.triangles.rows(), 32);
  // Turned by a quarter about z, doubled, shifted.
  const Eigen::RowVector3d p = patch_.positions.row(7);
  const Eigen::RowVector3d expected(1.0 - 2.0 * p.y(), 2.0 + 2.0 * p.x(), 3.0 + 2.0 * p.z());
  bool found = false;
  for (Eigen::Index t = 0; t < 32; ++t) {
    for (int k = 0; k < 3; ++k) {
      if ((scan.mesh.positions.row(scan.mesh.triangles(t, k)) - expected).norm() > 1e-6) continue;
      found = true;
      EXPECT_LT((scan.mesh.uvs.row(scan.mesh.uv_triangles(t, k)) - patch_.uvs.row(7)).norm(), 1e-6);
    }
  }
  EXPECT_TRUE(found);
  ASSERT_FALSE(scan.textures.at(0).empty());
  EXPECT_EQ(image::readImage(scan.textures[0]).samples, image::readImage(folder_ / "skin.png").samples);
}

TEST_F(GlbScan, ItsTexturesAreGoneWithIt) {
  fs::path texture;
  {
    const registration::Scan scan = registration::readScan(write());
    texture = scan.textures.at(0);
    EXPECT_TRUE(fs::exists(texture));
  }
  EXPECT_FALSE(fs::exists(texture));
}

TEST_F(GlbScan, AMirroringNodeKeepsTrianglesOutwards) {
  document_["nodes"][1] = {{"mesh", 0}, {"scale", {-1, 1, 1}}};
  document_["nodes"][0] = {{"children", {1}}};
  const geometry::TriangleMesh mesh = registration::readGlbScan(write()).textured.mesh;
  EXPECT_EQ(mesh.triangles(0, 1), patch_.triangles(0, 2));
  EXPECT_NEAR(mesh.positions(7, 0), -patch_.positions(7, 0), 1e-6);
}

TEST_F(GlbScan, DamagedFilesAreRefused) {
  const json good = document_;
  const auto breaking = [&](const std::string& part, const std::function<void(json&)>& change) {
    document_ = good;
    change(document_);
    expectRefused(part);
  };
  breaking("extensionsRequired", [](json& d) { d["extensionsRequired"] = {"KHR_draco_mesh_compression"}; });
  breaking("TEXCOORD_0", [](json& d) { d["meshes"][0]["primitives"][0]["attributes"].erase("TEXCOORD_0"); });
  breaking("images[0]", [](json& d) { d["images"][0] = {{"uri", "../../etc/passwd"}}; });
  breaking("mimeType", [](json& d) { d["images"][0]["mimeType"] = "image/webp"; });
  breaking("byteLength", [](json& d) { d["bufferViews"][3]["byteLength"] = 99999999; });
  breaking("uri", [](json& d) { d["buffers"][0]["uri"] = "other.bin"; });
  breaking("children", [](json& d) { d["nodes"][1]["children"] = {0}; });
  breaking("mode", [](json& d) { d["meshes"][0]["primitives"][0]["mode"] = 1; });
  breaking("accessors", [](json& d) { d["accessors"][2]["count"] = 9999; });
  breaking("rotation", [](json& d) { d["nodes"][1]["rotation"] = {0, 0, 0, 0}; });
  breaking("a mesh of triangles", [](json& d) { d["nodes"][1].erase("mesh"); });
  document_ = good;
  document_["meshes"][0]["primitives"][0].erase("indices");
  expectRefused("three corners");
  const std::string whole = io::readFile(write("whole.glb"), "a scan");
  document_ = good;
  for (const std::size_t length : {0u, 11u, 40u, 600u}) {
    io::writeTextFile(folder_ / "cut.glb", whole.substr(0, length));
    EXPECT_THROW(registration::readGlbScan(folder_ / "cut.glb"), InputError);
  }
}

TEST_F(GlbScan, AScanOfEachKindIsTakenButNotTwoOfOneName) {
  write("neutral.glb");
  write("open.glb");
  io::writeTextFile(folder_ / "landmarks.json", R"({"neutral": {"a": [0, 0, 0]}, "open": {"a": [0, 0, 0]}})");
  const registration::ScanFolder folder = registration::openScans(folder_.path(), {});
  EXPECT_EQ(folder.neutral.filename(), "neutral.glb");
  ASSERT_EQ(folder.expressions.size(), 1u);
  geometry::writeObj(folder_ / "open.obj", patch_);
  EXPECT_THROW(registration::openScans(folder_.path(), {}), InputError);
}

}  // namespace
}  // namespace facezip
