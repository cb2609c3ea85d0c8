#include "rig/rig_template.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mesh/gltf_scene.hpp"
#include "notes.hpp"
#include "rig_capture.hpp"
#include "temporary_directory.hpp"

namespace facezip {
namespace {
namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

class RigTemplateTest : public testing::Test {
 protected:
  RigTemplateTest() { test::writeRigCapture(folder_.path()); }
  fs::path folder() const { return folder_ / "template"; }
  rig::RigTemplate read() {
    notes_.all.clear();
    return rig::readTemplate(folder(), notes_);
  }

  test::TemporaryDirectory folder_;
  test::Notes notes_;
};

TEST_F(RigTemplateTest, IdentitiesAreNoShapes) {
  for (const char* name : {"identity000", "identity42", "identity", "identity1b"}) {
    fs::copy_file(folder() / "bumpA.obj", folder() / (std::string(name) + ".obj"));
  }
  EXPECT_THAT(read().names, ElementsAre("bumpA", "bumpB", "bumpC", "identity", "identity1b"));
  EXPECT_THAT(notes_.all, ElementsAre(HasSubstr("identityNNN.obj (2 of them) are no shapes")));
}

TEST_F(RigTemplateTest, TheNeutralHasSeveralNames) {
  fs::rename(folder() / "neutral.obj", folder() / "generic_neutral_mesh.obj");
  EXPECT_EQ(read().names.size(), 3u);
  EXPECT_THAT(notes_.all, testing::IsEmpty());
  fs::copy_file(folder() / "generic_neutral_mesh.obj", folder() / "neutral.obj");
  EXPECT_THROW(read(), InputError);
}

TEST_F(RigTemplateTest, ShapesMayBeTheMorphTargetsOfOneFile) {
  const rig::RigTemplate before = read();
  mesh::GltfScene scene;
  scene.neutral = before.neutral;
  for (std::size_t m = 0; m < before.names.size(); ++m) scene.targets.push_back({before.names[m], before.shapes[m]});
  mesh::writeGltf(folder_ / "shapes.glb", scene);
  fs::remove_all(folder());
  fs::create_directory(folder());
  fs::rename(folder_ / "shapes.glb", folder() / "shapes.glb");
  const rig::RigTemplate found = read();
  EXPECT_EQ(found.names, before.names);
  ASSERT_EQ(found.neutral.triangles.rows(), before.neutral.triangles.rows());
  for (std::size_t m = 0; m < found.names.size(); ++m) {
    for (Eigen::Index t = 0; t < found.neutral.triangles.rows(); ++t) {
      const Eigen::RowVector3d got = found.shapes[m].row(found.neutral.triangles(t, 1)),
                               expected = before.shapes[m].row(before.neutral.triangles(t, 1));
      EXPECT_LT((got - expected).norm(), 1e-5);
    }
  }
  fs::copy_file(folder() / "shapes.glb", folder() / "more.glb");
  EXPECT_THROW(read(), InputError);
}

// Wherever the head stands: displacements do not move with it.
TEST_F(RigTemplateTest, DisplacementsAreAddedToTheNeutral) {
  for (const double away : {0.0, 50.0}) {
    geometry::TriangleMesh neutral = geometry::readObj(folder() / "neutral.obj");
    neutral.positions.col(1).array() += away;
    geometry::writeObj(folder() / "neutral.obj", neutral);
    for (int m = 0; m < 3; ++m) {
      geometry::TriangleMesh shape = neutral;
      shape.positions = test::templateShape(m);
      if (m == 2) shape.positions += neutral.positions;
      geometry::writeObj(folder() / (std::string(test::kRigShapes[m]) + ".obj"), shape);
    }
    const rig::RigTemplate found = read();
    for (int m = 0; m < 3; ++m) {
      const Eigen::MatrixX3d expected = neutral.positions + test::templateShape(m);
      EXPECT_LT((found.shapes[static_cast<std::size_t>(m)] - expected).cwiseAbs().maxCoeff(), 1e-12) << m;
    }
    EXPECT_THAT(notes_.all, ElementsAre(HasSubstr("2 of 3 shapes hold displacements, not positions: added to the")));
  }
}

TEST_F(RigTemplateTest, NamesAreComparedAsTheyLook) {
  fs::rename(folder() / "bumpA.obj", folder() / "e\u0301.obj");
  EXPECT_THAT(read().names, ElementsAre("bumpB", "bumpC", "\u00e9"));
  fs::copy_file(folder() / "bumpB.obj", folder() / "\u00e9.obj");
  EXPECT_THROW(read(), InputError);
}

}  // namespace
}  // namespace facezip
