// Compress and stretch maps from meshes: influences against a reference, and the whole method through a package.
#include "compress/compress_stretch.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "facezip/blend.hpp"
#include "facezip/compress.hpp"
#include "facezip/package.hpp"
#include "facezip/rig.hpp"
#include "raster/cell_samples.hpp"
#include "reference/compress_stretch.hpp"
#include "rig/shape_codes.hpp"
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
  const EncodedWeights encoded = encodeShares(normalisedInfluences(mesh, influences, raster, 8));
  ASSERT_EQ(encoded.codes.size(), 3u * 25 * 2);
  const auto samples = raster::cellSamples(raster, 8);
  for (std::size_t cell = 0; cell < 25; ++cell) {
    for (std::size_t i = 0; i < 2; ++i) {
      int sum = 0;
      for (std::size_t n = 0; n < 3; ++n) sum += encoded.codes[(n * 25 + cell) * 2 + i];
      EXPECT_NEAR(sum * encoded.scale[i], 1.0, 1e-12);
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
        EXPECT_NEAR(encoded.codes[(n * 25 + cell) * 2 + i] * encoded.scale[i], expected[n], encoded.scale[i] + 1e-6);
      }
    }
  }
}

/// Where nothing moves all shares are 1/N: rounded one by one to 255 steps, a hundred of them would sum to 1.18.
TEST(Influences, KeepTheirSumsWhateverTheNumberOfExpressions) {
  const geometry::TriangleMesh mesh = test::gridMesh(9);
  const std::vector<int> region = geometry::wholeMeshRegion(mesh);
  const raster::UvRaster raster(mesh, region, 64, 64, 16);
  for (const int expressions : {1, 3, 45, 100, 300}) {
    for (const bool still : {true, false}) {
      Eigen::MatrixXd influences = Eigen::MatrixXd::Zero(mesh.positions.rows(), 2 * expressions);
      for (Eigen::Index v = 0; v < influences.rows() && !still; ++v) {
        for (Eigen::Index c = 0; c < influences.cols(); ++c) {
          influences(v, c) = std::max(0.0, 4 * std::sin(0.7 * static_cast<double>(v) + 1.3 * static_cast<double>(c)));
        }
      }
      const InfluenceShares shares = normalisedInfluences(mesh, influences, raster, 8);
      const EncodedWeights encoded = encodeShares(shares);
      const auto count = static_cast<std::size_t>(expressions);
      for (std::size_t i = 0; i < 2; ++i) {
        std::vector<double> mean(count, 0.0);
        // Eq. 13 of expressions that all look alike, and of textures that do not, in double.
        double largest = 0.0, off = 0.0, expected_map = 0.0;
        for (std::size_t cell = 0; cell < 64; ++cell) {
          double sum = 0.0, map = 0.0, expected = 0.0;
          for (std::size_t n = 0; n < count; ++n) {
            const double share = encoded.codes[(n * 64 + cell) * 2 + i] * encoded.scale[i];
            const double wanted = static_cast<double>(shares.shares[(cell * 2 + i) * count + n]);
            const double texture = 20.0 + 10.0 * std::sin(2.1 * static_cast<double>(n));
            EXPECT_LT(std::abs(share - wanted), encoded.scale[i]);
            mean[n] += (share - wanted) / 64;
            sum += share;
            map += share * texture;
            expected += wanted * texture;
          }
          EXPECT_NEAR(sum, 1.0, 1e-12);
          off += (map - expected) / 64;
          expected_map += expected / 64;
          largest = std::max(largest, std::abs(map - expected));
        }
        EXPECT_NEAR(off, 0.0, 0.004 * expected_map) << expressions;
        EXPECT_LT(largest, 0.05 * expected_map) << expressions;
        for (const double error : mean) EXPECT_LT(std::abs(error), 0.25 * encoded.scale[i]) << "none is favoured";
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

/// The shapes of a rig blend the two maps by their own strain (Eq. 14), and their shares are a whole as well.
TEST(CompressStretchMethod, ShapesOfARigBlendByTheirOwnStrain) {
  const test::TemporaryDirectory folder;
  test::writeRigCapture(folder.path());
  RigOptions options;
  options.compress.method = Method::kCompressStretch;
  options.compress.unit = "m";
  options.compress.mask_radius = geometry::parseLength("5cm");
  options.fit.iterations = 2;
  Progress progress;
  const Capture capture = openCapture(folder / "capture");
  compressCapture(capture, folder / "plain", options.compress, test::testDevice(), progress);
  const RigReport report =
      rigCapture(capture, folder / "template", folder / "rig", options, test::testDevice(), progress);
  EXPECT_EQ(report.texture_solve, "strain");
  const Package package = Package::open(folder / "rig");
  ASSERT_THAT(package.expressions(), testing::ElementsAre("r0", "r1", "r2", "r3", "bumpA", "bumpB", "bumpC"));
  const Eigen::MatrixXf decoded = rig::decodeSet(package, 0);
  EXPECT_LT((decoded.leftCols(4).rowwise().sum().array() - 1.0f).abs().maxCoeff(), 1e-5f);
  EXPECT_LT((decoded.rightCols(3).rowwise().sum().array() - 1.0f).abs().maxCoeff(), 1e-5f);
  // Eq. 10 to 12 of the rig's own meshes.
  const geometry::TriangleMesh neutral = geometry::readObj(folder / "rig/shapes/neutral.obj");
  std::vector<Eigen::MatrixX3d> shapes;
  for (const char* name : test::kRigShapes) {
    shapes.push_back(geometry::readObj(folder / "rig/shapes" / (std::string(name) + ".obj")).positions);
  }
  const std::vector<int> region = geometry::wholeMeshRegion(neutral);
  const raster::UvRaster raster(neutral, region, 64, 64, 16);
  const InfluenceShares expected = normalisedInfluences(neutral, vertexInfluences(neutral, shapes), raster, 8);
  const float step = static_cast<float>(package.weightSets()[0].scale[0]);
  for (Eigen::Index row = 0; row < decoded.rows(); ++row) {
    for (Eigen::Index m = 0; m < 3; ++m) {
      EXPECT_NEAR(decoded(row, 4 + m), expected.shares[static_cast<std::size_t>(row * 3 + m)], step + 1e-3f);
    }
  }
  const Package plain = Package::open(folder / "plain");
  const float both_steps = step + static_cast<float>(plain.weightSets()[0].scale[0]);
  EXPECT_LT((decoded.leftCols(4) - rig::decodeSet(plain, 0)).cwiseAbs().maxCoeff(), both_steps);

  options.texture_solve = TextureSolve::kLocal;
  EXPECT_THROW(rigCapture(capture, folder / "template", folder / "other", options, test::testDevice(), progress),
               InputError);
  options.compress.method = Method::kRefined;
  options.texture_solve = TextureSolve::kStrain;
  EXPECT_THROW(rigCapture(capture, folder / "template", folder / "other", options, test::testDevice(), progress),
               InputError);
  EXPECT_FALSE(std::filesystem::exists(folder / "other"));
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
