#include "facezip/synth.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <Eigen/Dense>
#include <cmath>
#include <fstream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <numeric>
#include <set>
#include <sstream>

#include "facezip/error.hpp"
#include "image/image_file.hpp"
#include "io/staged_directory.hpp"
#include "synth/chart_raster.hpp"
#include "synth/expressions.hpp"
#include "synth/head_mesh.hpp"
#include "synth/noise.hpp"
#include "synth/scanner.hpp"
#include "temporary_directory.hpp"

namespace facezip {
namespace {
namespace fs = std::filesystem;

std::string readText(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

/// Every file below `folder` with its bytes.
std::map<std::string, std::string> readTree(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) files[entry.path().lexically_relative(folder).string()] = readText(entry.path());
  }
  return files;
}

bool isEmpty(const fs::path& folder) { return fs::is_empty(folder); }

void synthesize(const fs::path& output, int resolution, int expressions, std::uint64_t seed,
                std::vector<std::string> maps = {"albedo", "normal"}) {
  Progress progress;
  synthesizeCapture(output, {resolution, expressions, std::move(maps), seed}, progress);
}

// ---- options and failures

struct BadOptions {
  const char* name;
  SynthOptions options;
};

class SynthOptionsTest : public testing::TestWithParam<BadOptions> {};

TEST_P(SynthOptionsTest, AreInputErrorsAndLeaveNothing) {
  const test::TemporaryDirectory folder;
  Progress progress;
  EXPECT_THROW(synthesizeCapture(folder / "a", GetParam().options, progress), InputError);
  EXPECT_TRUE(isEmpty(folder.path()));
}

INSTANTIATE_TEST_SUITE_P(Bad, SynthOptionsTest,
                         testing::Values(BadOptions{"ResolutionLow", {63, 1, {"albedo"}, 1}},
                                         BadOptions{"ResolutionHigh", {16385, 1, {"albedo"}, 1}},
                                         BadOptions{"NoExpressions", {64, 0, {"albedo"}, 1}},
                                         BadOptions{"TooManyExpressions", {64, 101, {"albedo"}, 1}},
                                         BadOptions{"NoMaps", {64, 1, {}, 1}},
                                         BadOptions{"UnknownMap", {64, 1, {"albedo", "glow"}, 1}},
                                         BadOptions{"RepeatedMap", {64, 1, {"albedo", "normal", "albedo"}, 1}}),
                         [](const auto& bad) { return std::string(bad.param.name); });

TEST(Synth, UnwritableOutputIsAnOutputErrorAndLeavesNothing) {
  const test::TemporaryDirectory folder;
  io::writeTextFile(folder / "file", "precious");
  EXPECT_THROW(synthesize(folder / "file", 64, 1, 1), OutputError);
  EXPECT_THROW(synthesize(folder / "file/below", 64, 1, 1), OutputError);
  EXPECT_THAT(readTree(folder.path()), testing::ElementsAre(testing::Pair("file", "precious")));
}

TEST(Synth, ReplacesAnEarlierCaptureWhole) {
  const test::TemporaryDirectory folder;
  synthesize(folder / "a", 64, 3, 1);
  synthesize(folder / "a", 64, 1, 1, {"albedo"});
  EXPECT_FALSE(fs::exists(folder / "a/normal"));
  EXPECT_FALSE(fs::exists(folder / "a/expressions/smile_open.obj"));
}

class CancelAfterFirstBand : public Progress {
 public:
  void stage(std::string_view name, std::size_t) override { painting_ = name == "textures"; }
  void advance(std::size_t) override {
    if (painting_) cancel();
  }

 private:
  bool painting_ = false;
};

TEST(Synth, CancellingLeavesNothing) {
  const test::TemporaryDirectory folder;
  CancelAfterFirstBand progress;
  EXPECT_THROW(synthesizeCapture(folder / "a", {128, 2, {"albedo"}, 1}, progress), Cancelled);
  EXPECT_TRUE(isEmpty(folder.path()));
}

// ---- what is written

TEST(Synth, SameOptionsGiveSameBytesOnAnyNumberOfThreads) {
  const test::TemporaryDirectory folder;
  synthesize(folder / "a", 100, 4, 7);
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  synthesize(folder / "b", 100, 4, 7);
  EXPECT_EQ(readTree(folder / "a"), readTree(folder / "b"));
}

TEST(Synth, AnotherSeedIsAnotherFace) {
  const test::TemporaryDirectory folder;
  synthesize(folder / "a", 64, 1, 1);
  synthesize(folder / "b", 64, 1, 2);
  const auto a = readTree(folder / "a");
  const auto b = readTree(folder / "b");
  ASSERT_EQ(a.size(), b.size());
  for (const auto& [name, bytes] : a) EXPECT_NE(bytes, b.at(name)) << name;
}

TEST(Synth, FewerExpressionsAreTheFirstOnes) {
  const test::TemporaryDirectory folder;
  synthesize(folder / "few", 64, 2, 3);
  synthesize(folder / "more", 64, 5, 3);
  const auto more = readTree(folder / "more");
  for (const auto& [name, bytes] : readTree(folder / "few")) {
    if (name != "capture.json") {
      EXPECT_EQ(bytes, more.at(name)) << name;
    }
  }
}

TEST(Synth, ManifestNamesTheFiles) {
  const test::TemporaryDirectory folder;
  synthesize(folder / "a", 64, 3, 5);
  const auto manifest = nlohmann::json::parse(readText(folder / "a/capture.json"));
  EXPECT_EQ(manifest["unit"], "m");
  EXPECT_EQ(manifest["seed"], 5);
  EXPECT_EQ(manifest["maps"]["albedo"]["colour_space"], "sRGB");
  EXPECT_EQ(manifest["maps"]["normal"]["colour_space"], "linear");
  ASSERT_EQ(manifest["expressions"].size(), 3u);
  for (const std::string name : manifest["expressions"]) {
    EXPECT_TRUE(fs::exists(folder / "a/albedo" / (name + ".png"))) << name;
    EXPECT_TRUE(fs::exists(folder / "a/normal" / (name + ".png"))) << name;
    EXPECT_TRUE(fs::exists(folder / "a/expressions" / (name + ".obj"))) << name;
  }
}

TEST(Synth, MapsHaveTheShapesPromised) {
  const test::TemporaryDirectory folder;
  synthesize(folder / "a", 70, 1, 1, {"displacement", "roughness", "albedo", "specular", "normal"});
  using image::SampleType;
  const auto shape = [&](const char* map) {
    return image::ImageReader(folder / "a" / map / "jaw_open_wide.png").shape();
  };
  EXPECT_EQ(shape("albedo"), (image::ImageShape{70, 70, 3, SampleType::kUint8}));
  EXPECT_EQ(shape("normal"), (image::ImageShape{70, 70, 3, SampleType::kUint8}));
  EXPECT_EQ(shape("specular"), (image::ImageShape{70, 70, 1, SampleType::kUint8}));
  EXPECT_EQ(shape("roughness"), (image::ImageShape{70, 70, 1, SampleType::kUint8}));
  EXPECT_EQ(shape("displacement"), (image::ImageShape{70, 70, 1, SampleType::kUint16}));
}

std::string topologyOf(const std::string& obj) { return obj.substr(obj.find("vt ")); }

TEST(Synth, MeshesShareTopologyAndUvs) {
  const test::TemporaryDirectory folder;
  synthesize(folder / "a", 64, 3, 1, {"albedo"});
  const std::string neutral = readText(folder / "a/neutral.obj");
  for (const auto& entry : fs::directory_iterator(folder / "a/expressions")) {
    const std::string expression = readText(entry.path());
    EXPECT_NE(expression, neutral);
    EXPECT_EQ(topologyOf(expression), topologyOf(neutral)) << entry.path();
  }
}

// ---- the mesh

class SynthSeed : public testing::TestWithParam<std::uint64_t> {};
INSTANTIATE_TEST_SUITE_P(Seeds, SynthSeed, testing::Values(1, 2, 3));

double uvArea(const geometry::TriangleMesh& mesh, Eigen::Index f) {
  const Eigen::RowVector2d a = mesh.uvs.row(mesh.uv_triangles(f, 0));
  const Eigen::RowVector2d ab = mesh.uvs.row(mesh.uv_triangles(f, 1)) - a;
  const Eigen::RowVector2d ac = mesh.uvs.row(mesh.uv_triangles(f, 2)) - a;
  return 0.5 * (ab.x() * ac.y() - ab.y() * ac.x());
}

/// Boundary edges as a map from the start of each to its end.
std::map<int, int> boundaryOf(const Eigen::MatrixX3i& triangles) {
  std::set<std::pair<int, int>> edges;
  for (Eigen::Index f = 0; f < triangles.rows(); ++f) {
    for (int k = 0; k < 3; ++k) edges.insert({triangles(f, k), triangles(f, (k + 1) % 3)});
  }
  EXPECT_EQ(edges.size(), static_cast<std::size_t>(3 * triangles.rows())) << "an edge has two triangles on one side";
  std::map<int, int> boundary;
  for (const auto& [from, to] : edges) {
    if (!edges.contains({to, from})) {
      EXPECT_TRUE(boundary.emplace(from, to).second) << "two borders meet in a vertex";
    }
  }
  return boundary;
}

int loopCount(const std::map<int, int>& boundary) {
  std::set<int> seen;
  int loops = 0;
  for (const auto& [from, to] : boundary) {
    if (!seen.insert(from).second) continue;
    for (int v = to; v != from; v = boundary.at(v)) seen.insert(v);
    ++loops;
  }
  return loops;
}

TEST_P(SynthSeed, MeshIsOneChartWithAnOutlineAndThreeHoles) {
  const synth::HeadMesh head{synth::HeadShape(GetParam())};
  const geometry::TriangleMesh& mesh = head.mesh;
  EXPECT_EQ(mesh.triangles.rows(), 20000);
  const std::map<int, int> boundary = boundaryOf(mesh.triangles);
  EXPECT_EQ(loopCount(boundary), 4);
  // Euler characteristic of one disk with three holes: 1 - 3.
  const auto edges = (3 * mesh.triangles.rows() + static_cast<Eigen::Index>(boundary.size())) / 2;
  EXPECT_EQ(mesh.positions.rows() - edges + mesh.triangles.rows(), -2);
}

TEST_P(SynthSeed, TrianglesAreSoundInSpaceAndInTheChart) {
  const synth::HeadMesh head{synth::HeadShape(GetParam())};
  const geometry::TriangleMesh& mesh = head.mesh;
  EXPECT_GT(mesh.uvs.minCoeff(), 0.015);
  EXPECT_LT(mesh.uvs.maxCoeff(), 0.985);
  for (Eigen::Index f = 0; f < mesh.triangles.rows(); ++f) {
    const Eigen::RowVector3d a = mesh.positions.row(mesh.triangles(f, 0));
    const Eigen::RowVector3d ab = mesh.positions.row(mesh.triangles(f, 1)) - a;
    const Eigen::RowVector3d ac = mesh.positions.row(mesh.triangles(f, 2)) - a;
    const double longest = std::max({ab.norm(), ac.norm(), (ab - ac).norm()});
    ASSERT_GT(uvArea(mesh, f), 1e-8) << "triangle " << f;
    ASSERT_GT(ab.cross(ac).norm(), 0.02 * longest * longest) << "triangle " << f;
    ASSERT_LT(longest, 0.015) << "triangle " << f;
  }
}

TEST(SynthMesh, IsHeadSizedInMetres) {
  const synth::HeadMesh head{synth::HeadShape(1)};
  const Eigen::RowVector3d size = head.mesh.positions.colwise().maxCoeff() - head.mesh.positions.colwise().minCoeff();
  EXPECT_NEAR(size.x(), 0.16, 0.02);
  EXPECT_NEAR(size.y(), 0.24, 0.02);
  EXPECT_GT(size.z(), 0.08);
}

TEST(SynthMesh, ChartDoesNotOverlapItself) {
  const synth::HeadMesh head{synth::HeadShape(1)};
  const geometry::TriangleMesh& mesh = head.mesh;
  synth::Random random(1);
  for (int i = 0; i < 1000; ++i) {
    const Eigen::RowVector2d point(random.uniform(), random.uniform());
    int triangles = 0;
    for (Eigen::Index f = 0; f < mesh.triangles.rows(); ++f) {
      bool inside = true;
      for (int k = 0; k < 3 && inside; ++k) {
        const Eigen::RowVector2d from = mesh.uvs.row(mesh.triangles(f, k));
        const Eigen::RowVector2d along = mesh.uvs.row(mesh.triangles(f, (k + 1) % 3)) - from;
        inside = along.x() * (point.y() - from.y()) - along.y() * (point.x() - from.x()) > 0.0;
      }
      triangles += inside ? 1 : 0;
    }
    ASSERT_LE(triangles, 1) << point;
  }
}

// ---- expressions

TEST_P(SynthSeed, EveryExpressionHasANameOfItsOwnAndMovesTheMesh) {
  const synth::HeadShape shape(GetParam());
  const synth::HeadMesh head(shape);
  std::set<std::string> names;
  for (const synth::Expression& expression : synth::makeExpressions(100, GetParam())) {
    EXPECT_TRUE(names.insert(expression.name).second) << expression.name;
    const Eigen::MatrixX3d positions = synth::deform(head, shape, expression.actions, expression.take);
    ASSERT_TRUE(positions.allFinite()) << expression.name;
    const double furthest = (positions - head.mesh.positions).rowwise().norm().maxCoeff();
    EXPECT_GT(furthest, 0.001) << expression.name;
    EXPECT_LT(furthest, 0.060) << expression.name;
  }
  EXPECT_EQ(names.size(), 100u);
}

TEST(SynthExpressions, FirstTwentyAreTheClassicalOnes) {
  const auto expressions = synth::makeExpressions(20, 1);
  EXPECT_EQ(expressions.front().name, "jaw_open_wide");
  EXPECT_EQ(expressions[2].name, "smile_open");
  EXPECT_EQ(expressions.back().name, "jaw_forward_chin_raise");
}

TEST(SynthExpressions, LeaveTheRestOfTheFaceExactlyStill) {
  const synth::HeadShape shape(1);
  const synth::HeadMesh head(shape);
  const auto expressions = synth::makeExpressions(20, 1);
  const auto frown =
      std::find_if(expressions.begin(), expressions.end(), [](const auto& e) { return e.name == "frown_brow"; });
  const Eigen::MatrixX3d moved = synth::deform(head, shape, frown->actions, frown->take) - head.mesh.positions;
  for (std::size_t v = 0; v < head.skin.size(); ++v) {
    if (head.skin[v].t < 0.03) {
      ASSERT_EQ(moved.row(static_cast<Eigen::Index>(v)).norm(), 0.0) << "vertex " << v;
    }
  }
}

// ---- the raster

TEST(SynthRaster, CoveredTexelsAreWhereTheyShouldBe) {
  const synth::HeadMesh head{synth::HeadShape(2)};
  constexpr int kResolution = 137;
  const synth::ChartRaster raster(head.mesh, kResolution);
  int inside = 0;
  std::vector<synth::MeshPoint> points(kResolution);
  for (int row = 0; row < kResolution; ++row) {
    raster.rasteriseRow(row, points);
    for (int x = 0; x < kResolution; ++x) {
      const synth::MeshPoint& point = points[static_cast<std::size_t>(x)];
      ASSERT_GE(point.triangle, 0);
      const auto uv = [&](int k) {
        return Eigen::RowVector2d(head.mesh.uvs.row(head.mesh.triangles(point.triangle, k)));
      };
      const double b1 = point.b1, b2 = point.b2;
      ASSERT_GE(std::min({b1, b2, 1.0 - b1 - b2}), -1e-4);
      const Eigen::RowVector2d shown = (1.0 - b1 - b2) * uv(0) + b1 * uv(1) + b2 * uv(2);
      const Eigen::RowVector2d centre((x + 0.5) / kResolution, 1.0 - (row + 0.5) / kResolution);
      inside += (shown - centre).norm() < 1e-5 ? 1 : 0;
    }
  }
  double area = 0.0;
  for (Eigen::Index f = 0; f < head.mesh.triangles.rows(); ++f) area += uvArea(head.mesh, f);
  EXPECT_NEAR(inside, area * kResolution * kResolution, 0.005 * area * kResolution * kResolution);
}

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

class SynthCapture : public SynthSeed {
 protected:
  static constexpr int kResolution = 256;

  /// A capture of `expressions` expressions, gone with the test.
  fs::path capture(int expressions) {
    synthesize(folder_ / "capture", kResolution, expressions, GetParam());
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
  synthesize(folder / "small", kResolution / 2, 1, GetParam(), {"albedo"});
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
