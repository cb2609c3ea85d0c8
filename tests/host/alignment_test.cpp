#include "facezip/alignment.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "align/slide_field.hpp"
#include "facezip/geometry/obj_io.hpp"
#include "facezip/geometry/uv_slide.hpp"
#include "facezip/report.hpp"
#include "facezip/synth.hpp"
#include "file_contents.hpp"
#include "image/image_file.hpp"
#include "image/set_sample.hpp"
#include "small_capture.hpp"
#include "temporary_directory.hpp"
#include "test_device.hpp"

namespace facezip {
namespace {
namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr int kSide = 320;

/// How far texel x, y of a spoilt texture slides, in texels.
Eigen::RowVector2d slideAt(double x, double y) {
  return {3.0 * std::sin(0.012 * x + 0.017 * y + 0.4), 2.5 * std::cos(0.015 * x - 0.011 * y)};
}

/// Bilinear; a capture's textures are smoother than their texels.
float sampleBetween(const image::Image& image, double x, double y, int channel) {
  const double left = std::clamp(x, 0.0, image.shape.width - 1.001),
               top = std::clamp(y, 0.0, image.shape.height - 1.001);
  const int i = static_cast<int>(left), j = static_cast<int>(top);
  const auto at = [&](int column, int row) {
    return double{image::sampleAt(
        image, static_cast<std::size_t>((row * image.shape.width + column) * image.shape.channels + channel))};
  };
  const double right = left - i, down = top - j;
  return static_cast<float>((1 - down) * ((1 - right) * at(i, j) + right * at(i + 1, j)) +
                            down * ((1 - right) * at(i, j + 1) + right * at(i + 1, j + 1)));
}

/// The built-in head, once; a copy of it whose textures and meshes slide; and both aligned.
struct Captures {
  test::TemporaryDirectory folder;
  AlignmentReport of_spoilt, of_good;

  Captures() {
    Progress progress;
    SynthOptions options;
    options.resolution = kSide;
    options.expressions = 2;
    options.seed = 3;
    synthesizeCapture(folder / "good", options, progress);
    fs::copy(folder / "good", folder / "spoilt", fs::copy_options::recursive);
    for (const std::string& name : names()) spoil(name);
    of_spoilt =
        alignCapture(openCapture(folder / "spoilt"), folder / "spoilt_aligned", {}, test::testDevice(), progress);
    of_good = alignCapture(openCapture(folder / "good"), folder / "good_aligned", {}, test::testDevice(), progress);
  }
  std::vector<std::string> names() const { return openCapture(folder / "good").expressions; }

  void spoil(const std::string& name) const {
    for (const char* map : {"albedo", "normal"}) {
      const fs::path file = folder / "spoilt" / map / (name + ".png");
      const image::Image texture = image::readImage(file);
      image::Image slid = texture;
      for (int y = 0; y < kSide; ++y) {
        for (int x = 0; x < kSide; ++x) {
          const Eigen::RowVector2d slide = slideAt(x, y);
          for (int c = 0; c < 3; ++c) {
            image::setSample(slid, static_cast<std::size_t>((y * kSide + x) * 3 + c),
                             sampleBetween(texture, x + slide.x(), y + slide.y(), c));
          }
        }
      }
      image::writeImage(file, slid);
    }
    const fs::path file = folder / "spoilt/expressions" / (name + ".obj");
    geometry::TriangleMesh mesh = geometry::readObj(file);
    Eigen::MatrixX2d vectors(mesh.uvs.rows(), 2);
    for (Eigen::Index v = 0; v < vectors.rows(); ++v) {
      const Eigen::RowVector2d slide = slideAt(mesh.uvs(v, 0) * kSide - 0.5, (1.0 - mesh.uvs(v, 1)) * kSide - 0.5);
      vectors.row(v) << slide.x() / kSide, -slide.y() / kSide;
    }
    mesh.positions = geometry::slideAlongUvs(mesh, vectors);
    geometry::writeObj(file, mesh);
  }

  /// Root mean square difference of a map of one expression from the good capture's, 0..255.
  double textureError(const std::string& capture, const std::string& map, const std::string& name) const {
    const image::Image a = image::readImage(folder / "good" / map / (name + ".png"));
    const image::Image b = image::readImage(folder / capture / map / (name + ".png"));
    double sum = 0.0;
    for (std::size_t i = 0; i < a.samples.size(); ++i) {
      const double difference = 255.0 * double{image::sampleAt(a, i) - image::sampleAt(b, i)};
      sum += difference * difference;
    }
    return std::sqrt(sum / static_cast<double>(a.samples.size()));
  }
  /// Mean distance of its vertices from the good capture's, millimetres.
  double meshError(const std::string& capture, const std::string& name) const {
    const fs::path file = fs::path("expressions") / (name + ".obj");
    const Eigen::MatrixX3d moved =
        geometry::readObj(folder / capture / file).positions - geometry::readObj(folder / "good" / file).positions;
    return 1000.0 * moved.rowwise().norm().mean();
  }
  static const Captures& once() {
    static const Captures made;
    return made;
  }
};

TEST(Alignment, TexturesThatSlidComeBackInEveryMap) {
  const Captures& made = Captures::once();
  for (const std::string& name : made.names()) {
    for (const char* map : {"albedo", "normal"}) {
      EXPECT_LT(made.textureError("spoilt_aligned", map, name), 0.6 * made.textureError("spoilt", map, name))
          << map << " " << name;
    }
  }
  for (const AlignedExpression& expression : made.of_spoilt.expressions) {
    EXPECT_TRUE(expression.moved);
    EXPECT_GT(expression.before_mean, 1.5);
    EXPECT_LT(expression.after_mean, 0.4);
    EXPECT_GT(expression.largest, 2.0);
    EXPECT_LT(expression.largest, 8.0);
  }
}

TEST(Alignment, MeshesMoveWithTheirTextures) {
  const Captures& made = Captures::once();
  for (const std::string& name : made.names()) {
    EXPECT_GT(made.meshError("spoilt", name), 1.0);
    EXPECT_LT(made.meshError("spoilt_aligned", name), 0.5 * made.meshError("spoilt", name));
  }
}

TEST(Alignment, WhatLiesRightStays) {
  const Captures& made = Captures::once();
  for (const AlignedExpression& expression : made.of_good.expressions) EXPECT_LT(expression.before_mean, 0.5);
  for (const std::string& name : made.names()) {
    EXPECT_LT(made.textureError("good_aligned", "albedo", name), 0.3 * made.textureError("spoilt", "albedo", name));
    EXPECT_LT(made.meshError("good_aligned", name), 0.3);
  }
  for (const char* file : {"neutral.obj", "albedo/neutral.png", "normal/neutral.png"}) {
    EXPECT_EQ(test::contentsOf(made.folder / "good_aligned" / file), test::contentsOf(made.folder / "good" / file));
  }
}

TEST(Alignment, TheResultIsTheSameCapture) {
  const Captures& made = Captures::once();
  const Capture from = openCapture(made.folder / "spoilt"), to = openCapture(made.folder / "spoilt_aligned");
  EXPECT_EQ(to.name, from.name);
  EXPECT_EQ(to.unit, from.unit);
  EXPECT_EQ(to.expressions, from.expressions);
  ASSERT_EQ(to.maps.size(), 2u);
  EXPECT_EQ(to.maps[0].colour_space, "sRGB");
  const nlohmann::json report = nlohmann::json::parse(toJson(made.of_spoilt));
  EXPECT_EQ(report["facezip_report"], "align");
  EXPECT_EQ(report["map"], "albedo");
  EXPECT_GT(report["expressions"][0]["flow_texels"]["before"]["mean"].get<double>(), 1.5);
}

TEST(Alignment, KeepsMeshesWhereAsked) {
  const Captures& made = Captures::once();
  const test::TemporaryDirectory out;
  Progress progress;
  AlignmentOptions options;
  options.keep_meshes = true;
  options.map = "normal";
  const AlignmentReport report =
      alignCapture(openCapture(made.folder / "spoilt"), out / "aligned", options, test::testDevice(), progress);
  EXPECT_EQ(report.map, "normal");
  const std::string file = "expressions/" + made.names()[0] + ".obj";
  EXPECT_EQ(test::contentsOf(out / "aligned" / file), test::contentsOf(made.folder / "spoilt" / file));
}

TEST(Alignment, BadInputIsRefusedAndLeavesNothing) {
  const test::TemporaryDirectory folder;
  test::writeSmallCapture(folder / "capture", {.expressions = 2});
  Progress progress;
  const auto align = [&](const AlignmentOptions& options, const fs::path& output) {
    alignCapture(openCapture(folder / "capture"), output, options, test::testDevice(), progress);
  };
  AlignmentOptions other;
  other.map = "colour";
  EXPECT_THROW(align(other, folder / "out"), InputError);
  EXPECT_THROW(align({}, folder / "capture"), OutputError);
  EXPECT_THROW(align({}, folder / "capture/albedo"), OutputError);
  image::writeImage(folder / "capture/albedo/e01.png",
                    test::makeImage({40, 40, 3, image::SampleType::kUint8}, [](int, int, int) { return 9.0; }));
  EXPECT_THROW(align({}, folder / "out"), InputError);
  EXPECT_FALSE(fs::exists(folder / "out"));
  fs::create_directories(folder / "strangers");
  fs::copy_file(folder / "capture/neutral.obj", folder / "strangers/neutral.obj");
  EXPECT_THROW(align({}, folder / "strangers"), OutputError);
}

TEST(SlideField, ComposesFlowsAndStaysOnItsIsland) {
  constexpr int kTexels = 64;
  // Two islands, left and right, a seam between them.
  const geometry::TriangleMesh patch = test::gridMesh(5, 0.0);
  geometry::TriangleMesh mesh = patch;
  mesh.uvs.col(0) *= 0.5;
  geometry::TriangleMesh right = mesh;
  right.uvs.col(0).array() += 0.5;
  mesh.positions.conservativeResize(50, 3);
  mesh.positions.bottomRows(25) = patch.positions.rowwise() + Eigen::RowVector3d(1, 0, 0);
  mesh.uvs.conservativeResize(50, 2);
  mesh.uvs.bottomRows(25) = right.uvs;
  mesh.triangles.conservativeResize(64, 3);
  mesh.triangles.bottomRows(32) = (patch.triangles.array() + 25).matrix();
  mesh.uv_triangles = mesh.triangles;
  std::vector<int> region(64);
  for (int t = 0; t < 64; ++t) region[static_cast<std::size_t>(t)] = t;
  const align::LayoutTexels texels = align::texelsOf(mesh, region, kTexels, kTexels);
  flow::TextureFlow flow{kTexels, kTexels, std::vector<float>(2 * kTexels * kTexels, 0.0f),
                         std::vector<float>(2 * kTexels * kTexels, 0.0f), std::vector<float>(kTexels * kTexels, 1.0f)};
  for (std::size_t i = 0; i < flow.forward.size(); i += 2) flow.forward[i] = 2.0f, flow.backward[i] = -2.0f;
  align::SlideField field = align::composed(align::stillField(kTexels, kTexels), flow, texels);
  field = align::composed(field, flow, texels);
  const auto at = [&](int x, int y) { return field.vectors[static_cast<std::size_t>(2 * (y * kTexels + x))]; };
  EXPECT_NEAR(at(10, 30), 4.0f, 1e-4f);
  EXPECT_NEAR(at(40, 30), 4.0f, 1e-4f);
  for (int x = 27; x < 32; ++x) EXPECT_LT(static_cast<float>(x) + at(x, 30), 32.0f);  // the seam is at 32
  // Twice as large a texture slides by twice as many texels.
  const std::vector<float> places = align::placesOf(field, 60, 61, 2 * kTexels, 2 * kTexels);
  EXPECT_NEAR(places[2 * 20], 20.0f + 8.0f, 1e-3f);
  EXPECT_NEAR(places[2 * 20 + 1], 60.0f, 1e-3f);
}

}  // namespace
}  // namespace facezip
