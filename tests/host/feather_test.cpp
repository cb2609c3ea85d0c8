// Beyond the region's border differences fade out instead of stopping, and nothing inside loses by it.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

#include "facezip/compress.hpp"
#include "facezip/package.hpp"
#include "facezip/reconstruct.hpp"
#include "io/staged_directory.hpp"
#include "kind_capture.hpp"
#include "raster/texel_masks.hpp"
#include "raster/uv_raster.hpp"
#include "temporary_directory.hpp"
#include "test_device.hpp"

namespace facezip {
namespace {
using Kind = raster::TexelSample::Kind;
using test::testDevice;

TEST(FeatherRaster, ReachesWhereTheMeshGoesOn) {
  const geometry::TriangleMesh mesh = test::gridMesh(3, 0.0);
  const std::vector<int> region = {0, 1};  // the lower left quarter
  const int side = 40, feather = 7;
  const raster::UvRaster raster(mesh, region, side, side, 2, feather);
  const auto samples = raster.rows(0, side);
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      const raster::TexelSample& sample = samples[static_cast<std::size_t>(y * side + x)];
      const int dx = std::max(0, x - 19), dy = std::max(0, 20 - y);
      const int distance2 = dx * dx + dy * dy;
      const Kind expected = distance2 == 0                   ? Kind::kCovered
                            : distance2 <= feather * feather ? Kind::kFeather
                                                             : Kind::kOutside;
      ASSERT_EQ(sample.kind, expected) << x << ", " << y;
      if (expected == Kind::kOutside) continue;
      EXPECT_GE(sample.triangle, 0);
      const double t = std::sqrt(distance2) / (feather + 1);
      EXPECT_NEAR(sample.fade, 255.0 * (1.0 - t * t * (3.0 - 2.0 * t)), 0.5 + 1e-9);
    }
  }
  for (int begin = 0; begin < side; begin += 9) {
    const int end = std::min(begin + 9, side);
    const auto band = raster.rows(begin, end);
    for (std::size_t i = 0; i < band.size(); ++i) {
      const raster::TexelSample& whole = samples[static_cast<std::size_t>(begin * side) + i];
      ASSERT_EQ(band[i].kind, whole.kind);
      ASSERT_EQ(band[i].fade, whole.fade);
    }
  }
}

/// Islands that are neighbours in the layout alone.
TEST(FeatherRaster, DoesNotCrossGapsOfTheLayout) {
  geometry::TriangleMesh mesh = test::gridMesh(2, 0.0);
  mesh.uvs.col(0) *= 0.45;  // the left of the image; a copy to the right
  geometry::TriangleMesh both = mesh;
  both.positions.resize(8, 3);
  both.positions << mesh.positions, mesh.positions;
  both.uvs.resize(8, 2);
  both.uvs << mesh.uvs, mesh.uvs;
  both.uvs.bottomRows(4).col(0).array() += 0.55;
  both.triangles.resize(4, 3);
  both.triangles << mesh.triangles, mesh.triangles.array() + 4;
  both.uv_triangles = both.triangles;
  const int side = 40;
  const auto samples = raster::UvRaster(both, std::vector<int>{0, 1}, side, side, 1, 12).rows(0, side);
  int outside = 0;
  for (const raster::TexelSample& sample : samples) {
    EXPECT_NE(sample.kind, Kind::kFeather);
    outside += sample.kind == Kind::kOutside;
  }
  EXPECT_EQ(outside, 18 * side);
}

TEST(FeatherRaster, TilesHoldWhatFades) {
  const geometry::TriangleMesh mesh = test::gridMesh(3, 0.0);
  const std::vector<int> region = {0, 1};
  const int side = 40;
  const raster::UvRaster raster(mesh, region, side, side, 2, 7);
  const auto samples = raster.rows(0, side);
  const raster::TileMasks tiles = raster::activeTiles(raster::TexelClasses(raster), 16, side);
  ASSERT_EQ(tiles.fades.size(), tiles.texel_weights.size());
  for (std::size_t i = 0; i < tiles.fades.size(); ++i) {
    const int x = tiles.tiles[i / 256].x * 16 + static_cast<int>(i % 16);
    const int y = 16 + tiles.tiles[i / 256].y * 16 + static_cast<int>(i % 256) / 16;
    if (x >= side || y >= side) continue;
    const raster::TexelSample& sample = samples[static_cast<std::size_t>(y * side + x)];
    EXPECT_EQ(tiles.mask_weights[i], sample.triangle >= 0 ? 1.0f : 0.0f);
    EXPECT_EQ(tiles.texel_weights[i], sample.kind == Kind::kCovered ? 1.0f : 0.0f);
    EXPECT_FLOAT_EQ(tiles.fades[i], sample.triangle >= 0 ? sample.fade / 255.0f : 1.0f) << x << ", " << y;
  }
  const raster::TileMasks hard =
      raster::activeTiles(raster::TexelClasses(raster::UvRaster(mesh, region, side, side, 2)), 16, side);
  EXPECT_TRUE(hard.fades.empty());
}

/// A face of which the left half is compressed.
class Feather : public testing::Test {
 protected:
  static constexpr int kSide = 160, kExpressions = 6;
  static constexpr int kBorder = 80;  ///< the first column that is not of the region

  void write(const std::function<double(int, int, int, int)>& difference) {
    test::writeCapture(folder_ / "c", {"face", kExpressions, kSide, kSide, image::SampleType::kUint8, difference});
    std::string half;
    for (int t = 0; t < 800; ++t) {
      if (t / 2 % 20 < 10) half += std::to_string(t) + "\n";
    }
    io::writeTextFile(folder_ / "c/face_region.txt", half);
  }

  CompressReport compress(std::optional<int> feather) {
    CompressOptions options;
    options.unit = "m";
    options.mask_radius = {5.0, geometry::LengthUnit::kCentimetre};
    options.differences = 3;
    options.restarts = 10;
    options.cluster_restarts = 8;
    options.feather = feather;
    return compressCapture(openCapture(folder_ / "c"), folder_ / "p", options, testDevice(), progress_);
  }

  /// Largest change of frame less neutral from one column to the next, of all expressions, averaged over the rows.
  double largestStep(int from, int to) {
    reconstruct(Package::open(folder_ / "p"), folder_ / "frames", {}, testDevice(), progress_);
    const image::Image neutral = image::readImage(folder_ / "c/albedo/neutral.png");
    double largest = 0.0;
    for (int n = 0; n < kExpressions; ++n) {
      const image::Image frame = image::readImage(folder_ / "frames/albedo" / (test::smallExpressionName(n) + ".png"));
      const auto at = [&](int x, int y) {
        const auto i = static_cast<std::size_t>((y * kSide + x) * 3);
        return std::to_integer<int>(frame.samples[i]) - std::to_integer<int>(neutral.samples[i]);
      };
      for (int x = from; x < to; ++x) {
        double sum = 0.0;
        for (int y = 40; y < 120; ++y) sum += at(x, y) - at(x - 1, y);
        largest = std::max(largest, std::abs(sum) / 80.0);
      }
    }
    return largest;
  }

  const test::TemporaryDirectory folder_;
  Progress progress_;
};

double light(int, int, int, int n) { return 18.0 * std::sin(1.0 + 1.7 * n); }

TEST_F(Feather, TakesTheStepAtTheBorder) {
  write([](int x, int y, int c, int n) { return light(x, y, c, n) + 0.3 * test::wrinkles(x, y, c, n); });
  const CompressReport hard = compress(0);
  EXPECT_EQ(hard.feather, 0);
  const double step = largestStep(kBorder - 4, kBorder + 24);
  EXPECT_GT(step, 15.0);
  const CompressReport soft = compress(16);
  EXPECT_EQ(soft.feather, 16);
  EXPECT_LT(largestStep(kBorder - 4, kBorder + 24), 0.2 * step);
  EXPECT_EQ(soft.covered_texels, hard.covered_texels);
  EXPECT_LE(soft.rmse[0].second, 1.005 * hard.rmse[0].second) << "nothing inside loses";
}

TEST_F(Feather, IsThereWhereAnExpressionChangesTone) {
  write([](int x, int y, int c, int n) { return (n == 2 ? 6.0 : 0.0) + 0.3 * test::wrinkles(x, y, c, n); });
  CompressReport report = compress(std::nullopt);
  EXPECT_NEAR(report.border_step, 6.0, 2.0);
  EXPECT_EQ(report.feather, kSide / 32);
  // Noise of a scan is no step, and neither is what ends before the border.
  write([](int x, int y, int c, int n) { return 5.0 * test::noise(x, y, c, n) + (x < 60 ? light(x, y, c, n) : 0.0); });
  report = compress(std::nullopt);
  EXPECT_LT(report.border_step, 1.0);
  EXPECT_GT(report.border_step, 0.0);
  EXPECT_EQ(report.feather, 0);
}

TEST_F(Feather, WorksWithEveryMethodAndBlocks) {
  write(light);
  for (const Method method : {Method::kPaper, Method::kClosedLoop, Method::kRefined}) {
    CompressOptions options;
    options.unit = "m";
    options.mask_radius = {5.0, geometry::LengthUnit::kCentimetre};
    options.restarts = 5;
    options.method = method;
    options.feather = 16;
    if (method != Method::kPaper) options.texture_format = BlockFormat::kBc7;
    compressCapture(openCapture(folder_ / "c"), folder_ / "p", options, testDevice(), progress_);
    EXPECT_LT(largestStep(kBorder - 4, kBorder + 24), 5.0) << nameOf(method);
  }
}

}  // namespace
}  // namespace facezip
