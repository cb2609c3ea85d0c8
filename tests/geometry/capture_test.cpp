// capture_test.cpp - the whole of the geometry on a real face: the folder that FACEZIP_TEST_CAPTURE names, which must
// hold the ICT capture (20 expressions, unit cm, 18,460 triangles of face). Skipped without it.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "facezip/geometry/face_region.hpp"
#include "facezip/geometry/length.hpp"
#include "facezip/geometry/mask_weights.hpp"
#include "facezip/geometry/obj_io.hpp"
#include "facezip/geometry/surface_sampling.hpp"
#include "facezip/geometry/topology.hpp"

namespace facezip::geometry {
namespace {

class Capture : public testing::Test {
 protected:
  void SetUp() override {
    const char* folder = std::getenv("FACEZIP_TEST_CAPTURE");
    if (folder == nullptr || *folder == '\0') GTEST_SKIP() << "FACEZIP_TEST_CAPTURE is not set";
    folder_ = folder;
    neutral_ = readObj(folder_ / "neutral.obj");
  }
  RegionMesh face() const {
    const auto count = static_cast<int>(neutral_.triangles.rows());
    return extractRegion(neutral_, readTriangleIndices(folder_ / "face_region.txt", count));
  }

  std::filesystem::path folder_;
  TriangleMesh neutral_;
};

TEST_F(Capture, ExpressionsHaveTheTopologyOfTheNeutral) {
  EXPECT_NO_THROW(requireUvs(neutral_, "neutral.obj"));
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder_ / "expressions")) {
    const std::string name = entry.path().string();
    EXPECT_NO_THROW(requireSameTopology(neutral_, "neutral.obj", readObj(entry.path()), name)) << name;
    ++count;
  }
  EXPECT_EQ(count, 20);
}

TEST_F(Capture, UnitIsGuessed) { EXPECT_EQ(guessUnit(neutral_).unit, LengthUnit::kCentimetre); }

TEST_F(Capture, FaceIsOnePieceOfQuads) {
  const RegionMesh region = face();
  EXPECT_EQ(region.triangleCount(), 18460);
  EXPECT_EQ(region.vertexCount(), 9409);
  EXPECT_EQ(region.component_count, 1);
}

TEST_F(Capture, ThreeCentimetresGiveAboutSixtyMasks) {
  // 40 orders of an independent dart throwing gave 57 to 67, 62.6 in the mean.
  const double radius = toMeshUnits(kDefaultMaskRadius, guessUnit(neutral_).unit);
  const RegionMesh region = face();
  double mean = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const auto count = static_cast<double>(samplePoissonDisk(region, radius, seed).vertices.size());
    EXPECT_GE(count, 55);
    EXPECT_LE(count, 70);
    mean += count / 20;
  }
  EXPECT_NEAR(mean, 62.6, 1.5);
}

TEST_F(Capture, MasksAreSmoothLocalAndComplete) {
  const RegionMesh region = face();
  const SurfaceSamples samples = sampleByCount(region, 53, 1);  // the paper's number
  const Eigen::MatrixXd phi = solveMaskWeights(region, samples.vertices);
  EXPECT_LT((phi.rowwise().sum().array() - 1).abs().maxCoeff(), 1e-9);
  const MaskWeights masks = compactMaskWeights(phi);
  EXPECT_LT(masks.cost.mean_active_after, 8);
  EXPECT_LT(masks.cost.mean_removed, 0.04);
}

}  // namespace
}  // namespace facezip::geometry
