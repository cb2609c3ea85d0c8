// Compress and stretch maps from meshes: influences against a reference, and the whole method through a package.
#include "compress/compress_stretch.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "facezip/blend.hpp"
#include "facezip/compress.hpp"
#include "facezip/package.hpp"
#include "raster/cell_samples.hpp"
#include "reference/compress_stretch.hpp"
#include "rig_capture.hpp"
#include "temporary_directory.hpp"
#include "test_device.hpp"

namespace facezip::compress {
namespace {

std::vector<reference::Point> pointsOf(const Eigen::MatrixX3d& positions) {
  std::vector<reference::Point> points;
  for (const auto& row : positions.rowwise()) points.push_back({row[0], row[1], row[2]});
  return points;
}

std::vector<std::array<int, 3>> trianglesOf(const geometry::TriangleMesh& mesh) {
  std::vector<std::array<int, 3>> triangles;
  for (const auto& t : mesh.triangles.rowwise()) triangles.push_back({t[0], t[1], t[2]});
  return triangles;
}

TEST(Influences, AreThoseOfTheEquations) {
  const geometry::TriangleMesh mesh = test::gridMesh(9);
  std::vector<Eigen::MatrixX3d> expressions = {mesh.positions, mesh.positions};
  expressions[0].col(0) *= 1.2;
  expressions[1].col(1) = (expressions[1].col(1).array() * 20).sin() / 30;
  const Eigen::MatrixXd found = vertexInfluences(mesh, expressions);
  const auto before = reference::ringLengths(pointsOf(mesh.positions), trianglesOf(mesh));
  for (std::size_t n = 0; n < 2; ++n) {
    const auto after = reference::ringLengths(pointsOf(expressions[n]), trianglesOf(mesh));
    for (std::size_t v = 0; v < before.size(); ++v) {
      const double change = (after[v] - before[v]) / (kInfluenceUnit * before[v]);
      const auto row = static_cast<Eigen::Index>(v), column = static_cast<Eigen::Index>(2 * n);
      EXPECT_NEAR(found(row, column), std::max(0.0, -change), 1e-9);
      EXPECT_NEAR(found(row, column + 1), std::max(0.0, change), 1e-9);
    }
  }
}

TEST(Influences, TheUnitOfTheMeshDoesNotMatter) {
  geometry::TriangleMesh mesh = test::gridMesh(9);
  Eigen::MatrixX3d posed = mesh.positions;
  posed.col(0) = posed.col(0).array().square() * 5;
  const Eigen::MatrixXd metres = vertexInfluences(mesh, {posed});
  mesh.positions *= 1000;
  EXPECT_LT((vertexInfluences(mesh, {1000 * posed}) - metres).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(Influences, SumToOneAndFollowTheReferenceInEveryCell) {
  const geometry::TriangleMesh mesh = test::gridMesh(9);
  std::vector<Eigen::MatrixX3d> expressions(3, mesh.positions);
  expressions[0].col(0) *= 1.1;
  expressions[1].col(0) *= 0.9;
  expressions[2].col(1) *= 0.8;
  const Eigen::MatrixXd influences = vertexInfluences(mesh, expressions);
  const std::vector<int> region = geometry::wholeMeshRegion(mesh);
  const raster::UvRaster raster(mesh, region, 40, 40, 16);
  const EncodedWeights encoded = normalisedInfluences(mesh, influences, raster, 8);
  ASSERT_EQ(encoded.codes.size(), 3u * 25 * 2);
  const auto samples = raster::cellSamples(raster, 8);
  for (std::size_t cell = 0; cell < 25; ++cell) {
    for (std::size_t i = 0; i < 2; ++i) {
      int sum = 0;
      for (std::size_t n = 0; n < 3; ++n) sum += encoded.codes[(n * 25 + cell) * 2 + i];
      EXPECT_NEAR(sum, 255, 2);
      if (samples[cell].triangle < 0) continue;
      std::vector<double> here;
      for (Eigen::Index n = 0; n < 3; ++n) {
        double value = 0.0;
        const double shares[] = {static_cast<double>(samples[cell].b0), static_cast<double>(samples[cell].b1),
                                 1.0 - static_cast<double>(samples[cell].b0) - static_cast<double>(samples[cell].b1)};
        for (int c = 0; c < 3; ++c) {
          value +=
              shares[c] * influences(mesh.triangles(samples[cell].triangle, c), 2 * n + static_cast<Eigen::Index>(i));
        }
        here.push_back(value);
      }
      const std::vector<double> expected = reference::normalised(here, 1.0);
      for (std::size_t n = 0; n < 3; ++n) {
        EXPECT_NEAR(encoded.codes[(n * 25 + cell) * 2 + i] / 255.0, expected[n], 0.5 / 255 + 1e-9);
      }
    }
  }
}

TEST(CompressStretchMethod, MakesAPackageThatBlendsLikeAnyOther) {
  const test::TemporaryDirectory folder;
  test::writeRigCapture(folder.path());
  CompressOptions options;
  options.method = Method::kCompressStretch;
  options.unit = "m";
  options.mask_radius = geometry::parseLength("5cm");
  Progress progress;
  const Capture capture = openCapture(folder / "capture");
  compressCapture(capture, folder / "package", options, test::testDevice(), progress);
  const Package package = Package::open(folder / "package");
  EXPECT_EQ(package.differences(), 2);
  EXPECT_THAT(package.expressions(), testing::ElementsAre("r0", "r1", "r2", "r3"));
  EXPECT_THAT(package.methodJson(), testing::HasSubstr("compress-stretch"));
  // Eq. 14 where only r0 moves much: its texture comes back in part, and all zero is the neutral.
  Blender blender(package, test::testDevice());
  std::vector<std::byte> neutral(package.maps()[0].frameBytes()), frame(neutral.size());
  blender.blend(0, neutral);
  blender.setWeights(weightsByName(package, {{"r0", 1.0f}}));
  blender.blend(0, frame);
  const std::size_t texel = (42 * 64 + 21) * 3;
  EXPECT_GT(std::to_integer<int>(frame[texel]), std::to_integer<int>(neutral[texel]) + 10);
}

TEST(CompressStretchMethod, NeedsEveryMesh) {
  const test::TemporaryDirectory folder;
  test::writeRigCapture(folder.path());
  std::filesystem::remove(folder / "capture/expressions/r2.obj");
  CompressOptions options;
  options.method = Method::kCompressStretch;
  options.unit = "m";
  options.mask_radius = geometry::parseLength("5cm");
  Progress progress;
  try {
    compressCapture(openCapture(folder / "capture"), folder / "package", options, test::testDevice(), progress);
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("r2.obj"));
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "package"));
}

}  // namespace
}  // namespace facezip::compress
