#include "facezip/geometry/named_obj.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "../temporary_directory.hpp"

namespace facezip::geometry {
namespace {
using testing::ElementsAre;

constexpr char kSquares[] = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";

class NamedObj : public testing::Test {
 protected:
  NamedMesh read(const std::string& text) {
    std::ofstream(folder_ / "mesh.obj") << text;
    return readNamedObj(folder_ / "mesh.obj");
  }
  test::TemporaryDirectory folder_;
};

TEST_F(NamedObj, FacesAreCalledAsTheirMaterial) {
  const NamedMesh mesh = read(std::string("g head\n") + kSquares +
                              "usemtl eye left \nf 1 2 3\nusemtl teeth\nf 1 2 3\n" + "usemtl eye left\nf 2 3 4\n");
  EXPECT_THAT(mesh.names, ElementsAre("", "eye left", "teeth"));
  EXPECT_THAT(mesh.of_triangle, ElementsAre(0, 0, 1, 2, 1));
  EXPECT_FALSE(mesh.materials[1].has_value());
}

TEST_F(NamedObj, WithoutMaterialsAsTheirGroup) {
  const NamedMesh mesh = read(std::string(kSquares) + "g teeth\nf 1 2 3\no tongue\nf 1 2 3\n");
  EXPECT_THAT(mesh.names, ElementsAre("", "teeth", "tongue"));
  EXPECT_THAT(mesh.of_triangle, ElementsAre(0, 0, 1, 2));
}

TEST_F(NamedObj, MaterialsComeFromTheirLibrary) {
  std::ofstream(folder_ / "look.mtl") << "newmtl teeth\nKd 0.5 0.25 1\nd 0.5\nmap_Kd teeth.png\n"
                                         "newmtl far\nmap_Kd ../teeth.png\n";
  std::ofstream(folder_ / "teeth.png") << "anything";
  const NamedMesh mesh =
      read(std::string("mtllib look.mtl\n") + kSquares + "usemtl teeth\nf 1 2 3\nusemtl far\nf 1 2 3\n");
  ASSERT_TRUE(mesh.materials[1].has_value());
  EXPECT_THAT(mesh.materials[1]->colour, ElementsAre(0.5, 0.25, 1.0));
  EXPECT_EQ(mesh.materials[1]->opacity, 0.5);
  EXPECT_EQ(mesh.materials[1]->texture, folder_ / "teeth.png");
  // Whatever path is written, nothing outside the folder is looked at.
  EXPECT_EQ(mesh.materials[2]->texture, folder_ / "teeth.png");
}

}  // namespace
}  // namespace facezip::geometry
