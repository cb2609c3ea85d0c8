#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <string>

#include "../temporary_directory.hpp"
#include "facezip/error.hpp"
#include "facezip/geometry/textured_mesh.hpp"

namespace facezip::geometry {
namespace {
using testing::HasSubstr;

class PlyFile : public testing::Test {
 protected:
  TexturedMesh read(const std::string& text) {
    std::ofstream(path_, std::ios::binary) << text;
    return readTexturedPly(path_);
  }
  void expectRefused(const std::string& text, const std::string& part) {
    try {
      read(text);
      ADD_FAILURE() << "read what should be refused: " << part;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr("mesh.ply"));
      EXPECT_THAT(error.what(), HasSubstr(part));
    }
  }

  test::TemporaryDirectory directory_;
  std::filesystem::path path_ = directory_ / "mesh.ply";
};

template <typename... Values>
std::string bytesOf(bool big_endian, Values... values) {
  std::string bytes;
  const auto append = [&](auto value) {
    char buffer[sizeof value];
    std::memcpy(buffer, &value, sizeof value);
    if (big_endian) std::reverse(buffer, buffer + sizeof value);
    bytes.append(buffer, sizeof value);
  };
  (append(values), ...);
  return bytes;
}

const std::string kStart = "ply\nformat ascii 1.0\n";
const std::string kXyz = "property float x\nproperty float y\nproperty float z\n";
const std::string kCorners = "property list uchar int vertex_indices\n";

TEST_F(PlyFile, MeshlabsUvsOfFacesAndItsTextures) {
  for (const char* name : {"skin.png", "eye.png"}) std::ofstream(directory_ / name) << "x";
  const TexturedMesh read_mesh = read(kStart +
                                      "comment VCGLIB generated\ncomment TextureFile skin.png\n"
                                      "comment TextureFile C:\\scans\\eye.png\nelement vertex 4\n" +
                                      kXyz + "property int flags\nelement face 2\n" + kCorners +
                                      "property list uchar float texcoord\nproperty int texnumber\nend_header\n"
                                      "0 0 0 7\n1 0 0 7\n1 1 0 7\n0 1 0.5 7\n"
                                      "4 0 1 2 3 8 0 0 0.5 0 0.5 0.5 0 0.5 1\n3 0 1 2 6 0.1 0.2 0.3 0.4 0.5 0.6 0\n");
  const TriangleMesh& mesh = read_mesh.mesh;
  ASSERT_EQ(mesh.triangles.rows(), 3);
  EXPECT_EQ(mesh.triangles.row(1), Eigen::RowVector3i(0, 2, 3));
  EXPECT_EQ(mesh.polygons, (std::vector<int>{0, 0, 1}));
  EXPECT_EQ(mesh.positions.row(3), Eigen::RowVector3d(0, 1, 0.5));
  EXPECT_EQ(mesh.uvs.row(mesh.uv_triangles(1, 2)), Eigen::RowVector2d(0, 0.5));
  EXPECT_NEAR(mesh.uvs(mesh.uv_triangles(2, 1), 1), 0.4, 1e-6);
  EXPECT_EQ(read_mesh.materials, (std::vector<int>{1, 1, 0}));
  ASSERT_EQ(read_mesh.textures.size(), 3u);
  EXPECT_EQ(read_mesh.textures[0], directory_ / "skin.png");
  EXPECT_EQ(read_mesh.textures[1], directory_ / "eye.png");
  EXPECT_EQ(read_mesh.textures[2], "");
  EXPECT_EQ(read_mesh.colours.rows(), 0);
}

TEST_F(PlyFile, BlendersUvsAndColoursOfVerticesInBothOrdersOfBytes) {
  for (const bool big : {false, true}) {
    std::string text = std::string("ply\r\nformat binary_") + (big ? "big" : "little") +
                       "_endian 1.0\r\ncomment Created in Blender version 4.1.0\r\nelement vertex 3\r\n" + kXyz +
                       "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\n"
                       "property float s\nproperty float t\nelement face 1\nproperty list uchar uint vertex_indices\n"
                       "element edge 1\nproperty int vertex1\nproperty int vertex2\nend_header\n";
    for (int v = 0; v < 3; ++v) {
      text += bytesOf(big, static_cast<float>(v), v == 2 ? 1.0f : 0.0f, 0.25f, std::uint8_t{255},
                      static_cast<std::uint8_t>(51 * v), std::uint8_t{0}, std::uint8_t{9}, 0.5f, 0.1f);
    }
    text += bytesOf(big, std::uint8_t{3}, 2u, 0u, 1u, 5, 6);
    const TexturedMesh mesh = read(text);
    EXPECT_EQ(mesh.mesh.triangles, (Eigen::MatrixX3i(1, 3) << 2, 0, 1).finished());
    EXPECT_EQ(mesh.mesh.positions.row(2), Eigen::RowVector3d(2, 1, 0.25));
    EXPECT_EQ(mesh.mesh.uv_triangles, mesh.mesh.triangles);
    EXPECT_EQ(mesh.mesh.uvs(1, 0), 0.5);
    ASSERT_EQ(mesh.colours.rows(), 3);
    EXPECT_LT((mesh.colours.row(2) - Eigen::RowVector3f(1.0f, 0.4f, 0.0f)).norm(), 1e-6f);
  }
}

TEST_F(PlyFile, HostileOnesAreRefused) {
  const std::string triangle = "0 0 0\n1 0 0\n0 1 0\n";
  const std::string header = kStart + "element vertex 3\n" + kXyz + "element face 1\n" + kCorners + "end_header\n";
  EXPECT_EQ(read(header + triangle + "3 0 1 2\n").mesh.triangles.rows(), 1);
  expectRefused("plz\n", "begins with ply");
  expectRefused("ply\nend_header ascii 1.0\nelement vertex 3\nend_header\n", "second line");
  expectRefused(kStart + "property float x\nelement vertex 3\nend_header\n", "header");
  expectRefused(kStart + "element vertex 3\nelement face 1\n" + kCorners + "end_header\n", "header");
  expectRefused(kStart + "element nothing 18446744073709551615\nproperty int a\nend_header\n",
                "than the file can hold");
  expectRefused(kStart + "element vertex 3\n" + kXyz + "property half s\nend_header\n" + triangle, "PLY's types");
  expectRefused(kStart + "element vertex 3\n" + kXyz +
                    "element face 1\nproperty list uint int vertex_indices\nend_header\n" + triangle + "4000000000 1\n",
                "8 or 16 bits");
  expectRefused(kStart + "element vertex 3\n" + kXyz +
                    "element face 1\nproperty list char int vertex_indices\nend_header\n" + triangle + "-1 1\n",
                "negative");
  expectRefused(header.substr(0, header.find("end_header")), "end_header");
  expectRefused(header + triangle, "face 0");
  expectRefused(header + triangle + "3 0 1 3\n", "indices below 3");
  expectRefused(header + triangle + "3 0 1 -2\n", "indices below 3");
  expectRefused(header + triangle + "2 0 1\n", "3 corners");
  expectRefused(header + "0 0 nan\n1 0 0\n0 1 0\n3 0 1 2\n", "vertex 0");
  expectRefused(kStart + "element vertex 3\n" + kXyz + "element face 2\n" + kCorners +
                    "property list uchar float texcoord\nend_header\n" + triangle +
                    "3 0 1 2 6 0 0 0 0 0 0\n3 0 1 2 0\n",
                "of some alone");
  expectRefused(kStart + "element vertex 3\n" + kXyz + "end_header\n" + triangle, "no faces");
}

}  // namespace
}  // namespace facezip::geometry
