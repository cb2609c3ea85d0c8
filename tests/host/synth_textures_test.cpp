// What the built-in capture's scans promise, and how its textures differ.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "facezip/synth.hpp"
#include "image/image_file.hpp"
#include "synth/chart_raster.hpp"
#include "synth/expressions.hpp"
#include "synth/head_mesh.hpp"
#include "synth/scanner.hpp"
#include "temporary_directory.hpp"

namespace facezip {
namespace {
namespace fs = std::filesystem;

// ---- the scan

TEST(SynthScanner, NoiseIsAsStrongAsPromised) {
  const synth::Scanner scanner(5, synth::Scanner::Subject::kNeutral);
  double sum = 0.0, squares = 0.0;
  constexpr int kSide = 400;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      const double noise = scanner.noise(x, y, x % 3);
      sum += noise;
      squares += noise * noise;
    }
  }
  EXPECT_NEAR(sum / (kSide * kSide), 0.0, 0.01);
  EXPECT_NEAR(std::sqrt(squares / (kSide * kSide)), 0.8, 0.01);
  EXPECT_EQ(scanner.misalignment(0.3f, 0.6f), (std::array<float, 2>{0.0f, 0.0f}));
  EXPECT_EQ(scanner.gain(0.3f, 0.6f), (std::array<float, 3>{1.0f, 1.0f, 1.0f}));
}

TEST(SynthScanner, MisalignmentAndGainAreAsStrongAsPromised) {
  double squares = 0.0, largest_gain = 0.0;
  constexpr int kTakes = 20, kSide = 40;
  for (std::uint64_t take = 0; take < kTakes; ++take) {
    const synth::Scanner scanner(take, synth::Scanner::Subject::kExpression);
    for (int i = 0; i < kSide * kSide; ++i) {
      const float u = static_cast<float>(i % kSide) / kSide, v = static_cast<float>(i / kSide) / kSide;
      const auto [dx, dy] = scanner.misalignment(u, v);
      squares += dx * dx + dy * dy;
      ASSERT_LT(std::max(std::abs(dx), std::abs(dy)), 1.0f) << "more than the painter's margin allows for";
      for (const float gain : scanner.gain(u, v)) largest_gain = std::max(largest_gain, std::abs(gain - 1.0));
    }
  }
  EXPECT_NEAR(std::sqrt(squares / (kTakes * kSide * kSide)), 0.4, 0.04);
  EXPECT_LE(largest_gain, 0.01);
  EXPECT_GT(largest_gain, 0.005);
}

// ---- how the textures differ

class SynthCapture : public testing::TestWithParam<std::uint64_t> {
 protected:
  static constexpr int kResolution = 256;

  /// A capture of `expressions` expressions, gone with the test.
  fs::path capture(int expressions) {
    Progress progress;
    synthesizeCapture(folder_ / "capture", {kResolution, expressions, {"albedo", "normal"}, GetParam()}, progress);
    return folder_ / "capture";
  }

  /// Samples of the texels that the chart covers, 0..255.
  static Eigen::VectorXf covered(const fs::path& file) {
    const synth::HeadMesh head{synth::HeadShape(1)};
    static const std::vector<bool> mask = coverage(head);
    const image::Image image = image::readImage(file);
    std::vector<float> samples;
    for (std::size_t i = 0; i < image.samples.size(); ++i) {
      if (mask[i / 3]) samples.push_back(std::to_integer<std::uint8_t>(image.samples[i]));
    }
    return Eigen::Map<Eigen::VectorXf>(samples.data(), static_cast<Eigen::Index>(samples.size()));
  }

  /// Difference to the neutral over every texel, row-major RGB.
  static std::vector<float> difference(const fs::path& map, const std::string& expression) {
    const image::Image neutral = image::readImage(map / "neutral.png");
    const image::Image image = image::readImage(map / (expression + ".png"));
    std::vector<float> difference;
    for (std::size_t i = 0; i < image.samples.size(); ++i) {
      difference.push_back(
          static_cast<float>(std::to_integer<int>(image.samples[i]) - std::to_integer<int>(neutral.samples[i])));
    }
    return difference;
  }

  /// Root mean square of `difference` over skin around (s, t), metres.
  static double rmsAround(const std::vector<float>& difference, double s, double t, double radius) {
    const synth::Landmarks marks;
    double sum = 0.0;
    int count = 0;
    for (int row = 0; row < kResolution; ++row) {
      for (int x = 0; x < kResolution; ++x) {
        const double ds = ((x + 0.5) / kResolution - 0.5) * synth::HeadMesh::kUvExtent - s;
        const double dt =
            (0.5 - (row + 0.5) / kResolution) * synth::HeadMesh::kUvExtent + 0.5 * (marks.bottom + marks.top) - t;
        if (ds * ds + dt * dt > radius * radius) continue;
        for (int c = 0; c < 3; ++c)
          sum += std::pow(difference[static_cast<std::size_t>((row * kResolution + x) * 3 + c)], 2);
        count += 3;
      }
    }
    return std::sqrt(sum / count);
  }

  static Eigen::MatrixXd gram(const fs::path& map, const std::vector<std::string>& names) {
    const Eigen::VectorXf neutral = covered(map / "neutral.png");
    Eigen::MatrixXf differences(neutral.size(), static_cast<Eigen::Index>(names.size()));
    for (std::size_t n = 0; n < names.size(); ++n) {
      differences.col(static_cast<Eigen::Index>(n)) = covered(map / (names[n] + ".png")) - neutral;
    }
    return differences.cast<double>().transpose() * differences.cast<double>();
  }

  /// Share of the energy of the differences that the best four textures leave: PCA with the neutral as mean.
  static double leftByFour(const Eigen::MatrixXd& gram) {
    const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(gram).eigenvalues();
    return values.head(values.size() - 4).sum() / values.sum();
  }

 private:
  test::TemporaryDirectory folder_;

  static std::vector<bool> coverage(const synth::HeadMesh& head) {
    std::vector<bool> mask;
    const synth::ChartRaster raster(head.mesh, kResolution);
    std::vector<synth::MeshPoint> points(kResolution);
    for (int row = 0; row < kResolution; ++row) {
      raster.rasteriseRow(row, points);
      for (int x = 0; x < kResolution; ++x) {
        const synth::MeshPoint& p = points[static_cast<std::size_t>(x)];
        const auto uv = [&](int k) {
          return Eigen::RowVector2d(head.mesh.uvs.row(head.mesh.triangles(p.triangle, k)));
        };
        const Eigen::RowVector2d shown = (1.0 - p.b1 - p.b2) * uv(0) + p.b1 * uv(1) + p.b2 * uv(2);
        mask.push_back((shown - Eigen::RowVector2d((x + 0.5) / kResolution, 1.0 - (row + 0.5) / kResolution)).norm() <
                       1e-5);
      }
    }
    return mask;
  }
};
INSTANTIATE_TEST_SUITE_P(Seeds, SynthCapture, testing::Values(1, 2, 3));

TEST_P(SynthCapture, FourTexturesDoNotHoldIt) {
  std::vector<std::string> names;
  for (const synth::Expression& expression : synth::makeExpressions(20, GetParam())) names.push_back(expression.name);
  const fs::path folder = capture(20);
  const Eigen::MatrixXd albedo = gram(folder / "albedo", names);
  const Eigen::MatrixXd normal = gram(folder / "normal", names);
  for (const double left : {leftByFour(albedo), leftByFour(normal), leftByFour(albedo + normal)}) {
    EXPECT_GT(left, 0.15);
    EXPECT_LT(left, 0.45);
  }
}

TEST_P(SynthCapture, DifferencesStayWhereTheFaceMoves) {
  const fs::path folder = capture(4);
  const std::vector<float> frown = difference(folder / "albedo", "frown_brow");
  const std::vector<float> jaw = difference(folder / "albedo", "jaw_open_wide");
  // Two noises, two roundings, up to 1 % of gain drift and misaligned mottles are all that still skin may show.
  const double still = rmsAround(frown, 0.0, -0.033, 0.010);
  EXPECT_LT(still, 2.5);
  EXPECT_GT(rmsAround(frown, 0.0, 0.080, 0.010), 2.0 * still);
  EXPECT_GT(rmsAround(jaw, 0.0, -0.060, 0.012), 2.0 * still);
  EXPECT_LT(rmsAround(jaw, 0.0, 0.110, 0.012), 2.5);
}

TEST_P(SynthCapture, NormalsHaveUnitLength) {
  const Eigen::VectorXf samples = covered(capture(3) / "normal/smile_open.png");
  for (Eigen::Index i = 0; i < samples.size(); i += 3) {
    const Eigen::Vector3f normal = samples.segment<3>(i) / 127.5f - Eigen::Vector3f::Ones();
    ASSERT_NEAR(normal.norm(), 1.0f, 0.012f);
    ASSERT_GT(normal.z(), 0.3f);
  }
}

TEST_P(SynthCapture, AnotherResolutionShowsTheSameFace) {
  const test::TemporaryDirectory folder;
  Progress progress;
  synthesizeCapture(folder / "small", {kResolution / 2, 1, {"albedo"}, GetParam()}, progress);
  const image::Image small = image::readImage(folder / "small/albedo/neutral.png");
  const image::Image large = image::readImage(capture(1) / "albedo/neutral.png");
  double squares = 0.0;
  for (int i = 0; i < small.shape.width * small.shape.height * 3; ++i) {
    const int row = i / 3 / small.shape.width, x = i / 3 % small.shape.width, c = i % 3;
    double mean = 0.0;
    for (const int offset : {0, 1, kResolution, kResolution + 1}) {
      mean += 0.25 * std::to_integer<int>(
                         large.samples[static_cast<std::size_t>((2 * row * kResolution + 2 * x + offset) * 3 + c)]);
    }
    squares += std::pow(mean - std::to_integer<int>(small.samples[static_cast<std::size_t>(i)]), 2);
  }
  EXPECT_LT(std::sqrt(squares / (small.shape.width * small.shape.height * 3)), 4.0);
}

}  // namespace
}  // namespace facezip
