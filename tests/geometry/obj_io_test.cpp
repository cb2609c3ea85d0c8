#include "facezip/geometry/obj_io.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "../file_contents.hpp"
#include "../temporary_directory.hpp"
#include "facezip/error.hpp"
#include "facezip/geometry/textured_mesh.hpp"
#include "test_meshes.hpp"

namespace facezip::geometry {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class ObjFile : public testing::Test {
 protected:
  TriangleMesh read(const std::string& text) {
    std::ofstream(path_, std::ios::binary) << text;
    return readObj(path_);
  }
  std::string refusal(const std::string& text) {
    try {
      read(text);
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr("mesh.obj"));
      return error.what();
    }
    return "nothing was refused";
  }

  test::TemporaryDirectory directory_;
  std::filesystem::path path_ = directory_ / "mesh.obj";
};

const std::string kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
const std::string kSquareUvs = "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";

TEST_F(ObjFile, PolygonsBecomeFansWhateverTheirDiagonals) {
  // The diagonal 2 4 of the quad is the shorter one: tinyobjloader itself would cut there.
  const TriangleMesh mesh = read("v -9 0 0\nv 0 1 0\nv 9 0 0\nv 0 -1 0\nv -5 -5 0\nf 1 2 3 4\nf 1 2 3 4 5\nf 3 2 1\n");
  Eigen::MatrixX3i expected(6, 3);
  expected << 0, 1, 2, 0, 2, 3, 0, 1, 2, 0, 2, 3, 0, 3, 4, 2, 1, 0;
  EXPECT_EQ(mesh.triangles, expected);
  EXPECT_EQ(mesh.polygons, (std::vector<int>{0, 0, 1, 1, 1, 2}));
  EXPECT_EQ(mesh.uvs.rows(), 0);
  EXPECT_EQ(mesh.uv_triangles.rows(), 0);
}

TEST_F(ObjFile, ReadsSeparateUvsNormalsAndRelativeIndices) {
  const TriangleMesh mesh = read(kSquare + kSquareUvs + "vn 0 0 1\nf 1/4/1 2/3/1 3/2/1\nf -4/-1 -2/-2 -1/-3\n");
  Eigen::MatrixX3i triangles(2, 3), uv_triangles(2, 3);
  triangles << 0, 1, 2, 0, 2, 3;
  uv_triangles << 3, 2, 1, 3, 2, 1;
  EXPECT_EQ(mesh.triangles, triangles);
  EXPECT_EQ(mesh.uv_triangles, uv_triangles);
  EXPECT_EQ(mesh.uvs.row(3), Eigen::RowVector2d(0, 1));
}

TEST_F(ObjFile, ObjectsGroupsAndMaterialsAreOneMeshInFileOrder) {
  const TriangleMesh mesh = read("# made by hand\r\nmtllib none.mtl\r\no a\r\n" + kSquare +
                                 "g x y\r\nusemtl skin\r\nf 1 2 3\r\n\r\no b\r\n  v 5 5 5\r\ns 1\r\nusemtl eye\r\n"
                                 "f 2 3 5\r\nl 1 2\r\ng z\r\nusemtl skin\r\n\tf 1//  2 4\r\n");
  Eigen::MatrixX3i expected(3, 3);
  expected << 0, 1, 2, 1, 2, 4, 0, 1, 3;
  EXPECT_EQ(mesh.triangles, expected);
  EXPECT_EQ(mesh.positions.row(4), Eigen::RowVector3d(5, 5, 5));
}

TEST_F(ObjFile, AByteOrderMarkAndContinuedLinesAreRead) {
  const TriangleMesh plain = read(kSquare + kSquareUvs + "f 1/1 2/2 3/3 4/4\n");
  const TriangleMesh mesh =
      read("\xef\xbb\xbf" + kSquare + "# kept in C:\\meshes\\\n" + kSquareUvs + "f 1/1 \\\n 2/2\\\r\n3/3 4/4\r\n");
  EXPECT_EQ(mesh.positions, plain.positions);
  EXPECT_EQ(mesh.uvs, plain.uvs);
  EXPECT_EQ(mesh.triangles, plain.triangles);
  EXPECT_EQ(mesh.uv_triangles, plain.uv_triangles);
  // Lines are counted as in the file: v 1 to 4, f 5 and 6.
  EXPECT_THAT(refusal("\xef\xbb\xbf" + kSquare + "f 1 2 \\\n 3\nf 1 2 9\n"), HasSubstr("line 7: "));
  EXPECT_THAT(refusal(kSquare + "f 1 2 3 \\"), HasSubstr("nothing"));
}

TEST_F(ObjFile, KeepsVerticesThatNoFaceUsesAndEqualOnes) {
  const TriangleMesh mesh = read("v 9 9 9\nv 0 0 0\nv 0 0 0\nv 1 0 0\nv 0 0 0\nf 2 3 4\n");
  EXPECT_EQ(mesh.positions.rows(), 5);
  EXPECT_EQ(mesh.positions.row(0), Eigen::RowVector3d(9, 9, 9));
}

TEST_F(ObjFile, ReadsDoublePrecision) {
  const TriangleMesh mesh = read("v 12345678.125 1e-3 -.5\nv 1 0 0\nv 0 1 0 1.0\nf 1 2 3\n");
  EXPECT_DOUBLE_EQ(mesh.positions(0, 0), 12345678.125);
  EXPECT_DOUBLE_EQ(mesh.positions(0, 1), 1e-3);
  EXPECT_DOUBLE_EQ(mesh.positions(0, 2), -0.5);
}

TEST_F(ObjFile, WhatIsWrittenIsReadBack) {
  TriangleMesh mesh = test::makeSheet(5, 4);
  mesh.positions *= 1e-7 / 3;
  writeObj(path_, mesh);
  const TriangleMesh back = readObj(path_);
  EXPECT_EQ(back.triangles, mesh.triangles);
  EXPECT_EQ(back.uv_triangles, mesh.uv_triangles);
  // tinyobjloader adds up digits: a few units in the last place.
  EXPECT_LE((back.positions - mesh.positions).cwiseAbs().maxCoeff(), 1e-14 * mesh.positions.cwiseAbs().maxCoeff());
  EXPECT_LE((back.uvs - mesh.uvs).cwiseAbs().maxCoeff(), 1e-14);

  mesh.uvs.resize(0, 2);
  mesh.uv_triangles.resize(0, 3);
  writeObj(path_, mesh);
  EXPECT_EQ(readObj(path_).uvs.rows(), 0);
}

TEST_F(ObjFile, WritingWhereOneCannotIsAnOutputError) {
  const TriangleMesh mesh = test::makeSheet(5, 4);
  EXPECT_THROW(writeObj(directory_ / "none" / "mesh.obj", mesh), OutputError);
  if (std::filesystem::exists("/dev/full")) {
    EXPECT_THROW(writeObj("/dev/full", mesh), OutputError);
  }
}

TEST_F(ObjFile, MissingFileAndFolderAreRefused) {
  EXPECT_THROW(readObj(directory_ / "none.obj"), InputError);
  EXPECT_THROW(readObj(directory_.path()), InputError);
}

TEST_F(ObjFile, FilesOfAFolderByNameTheExtensionInAnyCase) {
  for (const char* name : {"b.OBJ", "a-2.obj", "a.Obj", ".b.obj", "a.png", "obj"}) std::ofstream(directory_ / name);
  std::filesystem::create_directory(directory_ / "folder.obj");  // an error when it is read
  EXPECT_THAT(objFiles(directory_.path()), testing::ElementsAre(directory_ / "a-2.obj", directory_ / "a.Obj",
                                                                directory_ / "b.OBJ", directory_ / "folder.obj"));
  EXPECT_THROW(objFiles(directory_ / "none"), InputError);
  std::ofstream(directory_ / "b.obj");
  EXPECT_THROW(objFiles(directory_.path()), InputError);
}

TEST_F(ObjFile, EmptyMeshesAreRefused) {
  EXPECT_THAT(refusal(""), HasSubstr("no vertices"));
  EXPECT_THAT(refusal("f 1 2 3\n"), HasSubstr("no vertices"));
  EXPECT_THAT(refusal(kSquare), HasSubstr("no faces"));
}

TEST_F(ObjFile, CoordinatesThatAreNoFiniteNumbersAreRefusedByLine) {
  for (const char* bad : {"nan", "inf", "-inf", "1e400", "x", "1,5", "0x10", ""}) {
    EXPECT_THAT(refusal(kSquare + "v 0 0 " + bad + "\nf 1 2 3\n"), AllOf(HasSubstr("line 5"), HasSubstr("finite")))
        << bad;
    EXPECT_THAT(refusal(kSquare + "\n\nvt 0 " + bad + "\nf 1/1 2/1 3/1\n"), HasSubstr("line 7")) << bad;
  }
}

TEST_F(ObjFile, IndicesOutOfRangeAreRefusedByLine) {
  for (const char* bad : {"1 2 5", "1 2 -5", "1 2 0", "1 2 x", "1 2 3000000000"}) {
    EXPECT_THAT(refusal(kSquare + "f 1 2 3\nf " + bad + "\n"), HasSubstr("line 6")) << bad;
  }
  EXPECT_THAT(refusal(kSquare + kSquareUvs + "f 1/1 2/2 3/5\n"), AllOf(HasSubstr("line 9"), HasSubstr("texture")));
  EXPECT_THAT(refusal(kSquare + "f 1/1 2/2 3/3\n"), HasSubstr("line 5"));
}

TEST_F(ObjFile, IndicesAreReadWholeOrRefused) {
  for (const char* bad : {"4294967297 2 3", "1 2 18446744073709551619", "1 2 -4294967295", "1.7/1.9 2/2 3/3",
                          "1x/1y 2/2 3/3", "1/1x 2/2 3/3", "1/4294967297 2/2 3/3", "1/1/x 2/2/1 3/3/1",
                          "1/1/1/1 2/2/1 3/3/1", "/1 2/2 3/3", "1e0 2 3", "0x1 2 3", "1/0 2/2 3/3"}) {
    EXPECT_THAT(refusal(kSquare + kSquareUvs + "vn 0 0 1\nf " + bad + "\n"), HasSubstr("line 10")) << bad;
  }
  // An index back may not reach beyond what stands before the line.
  EXPECT_THAT(refusal("v 0 0 0\nv 1 0 0\nf -1 -2 -3\nv 0 1 0\n"), HasSubstr("line 3"));
}

TEST_F(ObjFile, WeightsAndColoursBehindCoordinatesAreNumbersToo) {
  EXPECT_EQ(read("v 0 0 0 1\nv 1 0 0 0.5 0.25 1e-3\nv 0 1 0\nvt 0 0 0\nf 1/1 2/1 3/1\n").positions.rows(), 3);
  EXPECT_THAT(refusal("v 0 0 0 x\nf 1 1 1\n"), HasSubstr("line 1"));
  EXPECT_THAT(refusal(kSquare + "vt 0 0 x\nf 1 2 3\n"), HasSubstr("line 5"));
}

TEST_F(ObjFile, CommentsMayStandBehindNumbers) {
  const TriangleMesh mesh = read(
      "v 0 0 0 # first\nv 1 0 0# second\nv 1 1 0 # a path C:\\\nv 0 1 0\nvt 0 0 # corner\n"
      "g part#1\nf 1/1 2/1 3/1 # quad 4/1\n  f 1/1 3/1 4/1\t#\n");
  Eigen::MatrixX3i expected(2, 3);
  expected << 0, 1, 2, 0, 2, 3;
  EXPECT_EQ(mesh.positions.rows(), 4);
  EXPECT_EQ(mesh.triangles, expected);
}

TEST_F(ObjFile, FacesOfTooFewOrTooManyCornersAreRefused) {
  EXPECT_THAT(refusal(kSquare + "f 1 2\n"), HasSubstr("line 5"));
  std::string face = "f";
  for (int i = 0; i < 300; ++i) face += " 1";
  EXPECT_THAT(refusal(kSquare + face + "\n"), HasSubstr("300"));
}

TEST_F(ObjFile, FacesWithAndWithoutUvsAreRefused) {
  EXPECT_THAT(refusal(kSquare + kSquareUvs + "f 1/1 2/2 3/3\nf 1 2 3\n"), HasSubstr("line 10"));
  EXPECT_THAT(refusal(kSquare + kSquareUvs + "f 1 2 3\nf 1/1 2/2 3/3\n"), HasSubstr("line 10"));
  EXPECT_THAT(refusal(kSquare + kSquareUvs + "f 1/1 2 3/3\n"), HasSubstr("line 9"));
}

TEST_F(ObjFile, TexturesAreThoseOfTheMaterialsBesideTheMesh) {
  std::ofstream(directory_ / "a.mtl") << "newmtl skin\nmap_Kd -s 1 1 1 C:\\scans\\face one.png\n"
                                         "newmtl far\nmap_Kd ../away.png\nnewmtl plain\nKd 1 1 1\n";
  std::ofstream(directory_ / "face one.png") << "x";
  std::ofstream(directory_ / "away.png") << "x";
  std::ofstream(path_) << "mtllib a.mtl\n" + kSquare + kSquareUvs +
                              "f 1/1 2/2 3/3\nusemtl far\nf 1/1 3/3 4/4\nusemtl skin\nf 1/1 2/2 3/3 4/4\n"
                              "usemtl plain\nf 1/1 2/2 4/4\nusemtl nowhere\nf 2/2 3/3 4/4\n";
  const TexturedMesh mesh = readTexturedObj(path_);
  ASSERT_EQ(mesh.materials.size(), 6u);
  const auto texture = [&](std::size_t t) { return mesh.textures[static_cast<std::size_t>(mesh.materials[t])]; };
  EXPECT_EQ(texture(0), "");
  EXPECT_EQ(texture(1), directory_ / "away.png") << "a path that leaves the folder stands for its name";
  EXPECT_EQ(texture(2), directory_ / "face one.png");
  EXPECT_EQ(texture(3), directory_ / "face one.png");
  EXPECT_EQ(texture(4), "");
  EXPECT_EQ(texture(5), "");
  std::filesystem::remove(directory_ / "a.mtl");
  for (const std::filesystem::path& none : readTexturedObj(path_).textures) EXPECT_EQ(none, "");
}

TEST_F(ObjFile, TruncatedFilesAreReadOrRefusedButNeverCrash) {
  writeObj(path_, test::makeSheet(3, 3));
  const std::string whole = test::contentsOf(path_);
  for (std::size_t length = 0; length < whole.size(); ++length) {
    try {
      const TriangleMesh mesh = read(whole.substr(0, length));
      EXPECT_LT(mesh.triangles.maxCoeff(), mesh.positions.rows());
    } catch (const InputError&) {
    }
  }
}

}  // namespace
}  // namespace facezip::geometry
