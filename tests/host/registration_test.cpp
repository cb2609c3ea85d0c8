#include "facezip/registration.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "facezip/capture.hpp"
#include "facezip/error.hpp"
#include "facezip/geometry/closest_surface.hpp"
#include "facezip/geometry/deformation_transfer.hpp"
#include "facezip/geometry/topology.hpp"
#include "facezip/report.hpp"
#include "register/hole_filling.hpp"
#include "register/registration_picture.hpp"
#include "scan_set.hpp"
#include "temporary_directory.hpp"
#include "test_device.hpp"

namespace facezip {
namespace {
namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

constexpr int kSide = 128;

struct Notes : Progress {
  void note(std::string_view message) override { text += std::string(message) + "\n"; }
  std::string text;
};

/// Scans, and the capture that was made of them, once for all tests.
struct Registered {
  test::TemporaryDirectory folder;
  test::ScanSet set;
  RegistrationReport report;
  Notes notes;

  Registered() {
    set.write(folder / "scans", folder / "template");
    RegistrationOptions options;
    options.resolution = kSide;
    options.unit = "cm";
    options.maps = {"albedo", "normal", "displacement"};
    report =
        registerScans(folder / "scans", folder / "template", folder / "capture", options, test::testDevice(), notes);
  }
  static const Registered& once() {
    static const Registered made;
    return made;
  }
};

/// Distances in millimetres of a mesh of the capture (cm) from the truth (m), heads aligned.
geometry::Distances distancesOf(const fs::path& file, const Eigen::MatrixX3d& truth) {
  const Eigen::MatrixX3d mesh = 10.0 * geometry::readObj(file).positions;
  const Eigen::MatrixX3d goal = 1000.0 * truth;
  return geometry::distancesBetween(geometry::fitSimilarity(mesh, goal, {}, true).apply(mesh), goal);
}

TEST(Registration, MeshesLieOnTheScans) {
  const Registered& made = Registered::once();
  ASSERT_EQ(made.report.scans.size(), 2u);
  for (const RegisteredScan& scan : made.report.scans) {
    EXPECT_LT(scan.mean, 0.1) << scan.name;
    EXPECT_LT(scan.mean, scan.model_mean) << scan.name;
    EXPECT_GT(scan.matched, 0.95) << scan.name;
    EXPECT_GT(scan.coverage, 0.9) << scan.name;
  }
}

TEST(Registration, PointsKeepTheirPlaceOnTheSkin) {
  const Registered& made = Registered::once();
  const geometry::Distances neutral = distancesOf(made.folder / "capture/neutral.obj", made.set.truth(0.0));
  const geometry::Distances open = distancesOf(made.folder / "capture/expressions/open.obj", made.set.truth(0.8));
  EXPECT_LT(neutral.mean, 1.2);
  EXPECT_LT(open.mean, 1.2);
  // What textures are misaligned by: how the expression moves against the neutral, which slides less than either.
  const Eigen::MatrixX3d moved = 10.0 * (geometry::readObj(made.folder / "capture/expressions/open.obj").positions -
                                         geometry::readObj(made.folder / "capture/neutral.obj").positions);
  const Eigen::MatrixX3d truth = 1000.0 * (made.set.truth(0.8) - made.set.truth(0.0));
  EXPECT_GT(truth.rowwise().norm().mean(), 2.0);
  EXPECT_LT((moved - truth).rowwise().norm().mean(), 0.5);
}

TEST(Registration, TexturesAreTheScansInTheTemplatesLayout) {
  const Registered& made = Registered::once();
  const image::Image confidence = image::readImage(made.folder / "capture/confidence/open.png");
  ASSERT_EQ(confidence.shape, (image::ImageShape{kSide, kSide, 1, image::SampleType::kUint8}));
  const image::Image neutral = image::readImage(made.folder / "capture/albedo/neutral.png");
  const image::Image open = image::readImage(made.folder / "capture/albedo/open.png");
  ASSERT_EQ(open.shape, (image::ImageShape{kSide, kSide, 3, image::SampleType::kUint8}));
  double sum = 0.0, contrast = 0.0;
  int count = 0;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      const auto at = static_cast<std::size_t>(y * kSide + x);
      if (image::sampleAt(confidence, at) < 0.5f) continue;
      const double expected = test::ScanSet::skin((x + 0.5) / kSide, 1.0 - (y + 0.5) / kSide);
      sum += std::abs(255.0 * double{image::sampleAt(open, 3 * at)} - expected);
      contrast += std::abs(128.0 - expected);
      ++count;
    }
  }
  EXPECT_GT(count, kSide * kSide / 4);
  EXPECT_LT(sum, 0.2 * contrast) << "off by " << sum / count << " of " << contrast / count;
  // Neither black nor a seam where nothing was seen: the neutral's skin.
  for (std::size_t i = 0; i < static_cast<std::size_t>(kSide * kSide); ++i) {
    if (image::sampleAt(confidence, i) > 0.0f) continue;
    EXPECT_NEAR(double{image::sampleAt(open, 3 * i)}, double{image::sampleAt(neutral, 3 * i)}, 0.5);
  }
}

TEST(Registration, TheResultIsACapture) {
  const Registered& made = Registered::once();
  const Capture capture = openCapture(made.folder / "capture");
  EXPECT_THAT(capture.expressions, testing::ElementsAre("open"));
  ASSERT_EQ(capture.maps.size(), 3u);
  EXPECT_EQ(capture.maps[0].name, "albedo");
  EXPECT_EQ(capture.maps[1].colour_space, "linear");
  EXPECT_EQ(capture.unit, "cm");
  EXPECT_TRUE(capture.face_region.has_value());
  const geometry::TriangleMesh neutral = geometry::readObj(capture.neutral_mesh);
  EXPECT_NO_THROW(geometry::requireSameTopology(made.set.mesh(), "", neutral, ""));
}

TEST(Registration, FlowDrawsTexturesOntoTheNeutrals) {
  const Registered& made = Registered::once();
  const RegisteredScan& open = made.report.scans[1];
  EXPECT_GE(made.report.flow_side, 256);
  EXPECT_GE(open.flow_rounds, 1);
  EXPECT_GT(open.flow_trusted, 0.8);
  EXPECT_LT(open.flow_p95, open.flow_before_p95);
  EXPECT_EQ(made.report.scans[0].flow_rounds, 0);
  // How the expression moves against the neutral, with flow and without.
  RegistrationOptions options;
  options.resolution = kSide;
  options.unit = "cm";
  options.last_step = RegistrationStep::kBending;
  options.keep_colour = true;
  Notes notes;
  registerScans(made.folder / "scans", made.folder / "template", made.folder / "bent", options, test::testDevice(),
                notes);
  const Eigen::MatrixX3d truth = 1000.0 * (made.set.truth(0.8) - made.set.truth(0.0));
  const auto error = [&](const char* capture) {
    const Eigen::MatrixX3d moved = 10.0 * (geometry::readObj(made.folder / capture / "expressions/open.obj").positions -
                                           geometry::readObj(made.folder / capture / "neutral.obj").positions);
    return (moved - truth).rowwise().norm().mean();
  };
  EXPECT_LT(error("capture"), 0.9 * error("bent"));
  const image::Image kept = image::readImage(made.folder / "bent/albedo/open.png");
  double blue = 0.0, red = 0.0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(kSide * kSide); ++i) {
    red += double{image::sampleAt(kept, 3 * i)};
    blue += double{image::sampleAt(kept, 3 * i + 2)};
  }
  EXPECT_NEAR(blue / red, test::ScanSet::kLight[2] / test::ScanSet::kLight[0], 0.05);
}

TEST(Registration, TheLightOfTheNeutralIsThatOfAll) {
  const Registered& made = Registered::once();
  const RegisteredScan& open = made.report.scans[1];
  EXPECT_TRUE(made.report.scans[0].colour_gain.empty());
  ASSERT_EQ(open.colour_gain.size(), 3u);
  for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(open.colour_gain[c], test::ScanSet::kLight[c], 0.01);
  const image::Image texture = image::readImage(made.folder / "capture/albedo/open.png");
  double means[3] = {};
  for (std::size_t i = 0; i < 3u * kSide * kSide; ++i) means[i % 3] += double{image::sampleAt(texture, i)};
  EXPECT_NEAR(means[0] / means[1], 1.0, 0.01);
  EXPECT_NEAR(means[2] / means[1], 1.0, 0.01);
}

TEST(Registration, WhatTheMeshFollowsIsNeitherInNormalsNorInHeights) {
  const Registered& made = Registered::once();
  const image::Image normal = image::readImage(made.folder / "capture/normal/open.png");
  const image::Image height = image::readImage(made.folder / "capture/displacement/open.png");
  ASSERT_EQ(normal.shape, (image::ImageShape{kSide, kSide, 3, image::SampleType::kUint8}));
  ASSERT_EQ(height.shape, (image::ImageShape{kSide, kSide, 1, image::SampleType::kUint16}));
  const image::Image confidence = image::readImage(made.folder / "capture/confidence/open.png");
  double up = 0.0, off = 0.0, count = 0.0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(kSide * kSide); ++i) {
    if (image::sampleAt(confidence, i) < 0.9f) continue;
    up += 2.0 * double{image::sampleAt(normal, 3 * i + 2)} - 1.0;
    off += 4.0 * std::abs(double{image::sampleAt(height, i)} - 0.5);
    count += 1.0;
  }
  EXPECT_GT(up / count, 0.97);
  EXPECT_LT(off / count, 0.2);
}

TEST(Registration, ColouredVerticesOfPlyFilesAreATextureToo) {
  const Registered& made = Registered::once();
  const test::TemporaryDirectory folder;
  io::createDirectories(folder / "scans");
  fs::copy(made.folder / "scans/landmarks.json", folder / "scans/landmarks.json");
  for (const char* name : {"neutral", "open"}) {
    const geometry::TriangleMesh scan = geometry::readObj(made.folder / "scans/scans" / (std::string(name) + ".obj"));
    std::string text = fmt::format(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty double x\nproperty double y\nproperty double z\n"
        "property uchar red\nproperty uchar green\nproperty uchar blue\nelement face {}\n"
        "property list uchar int vertex_indices\nend_header\n",
        scan.positions.rows(), scan.triangles.rows());
    for (Eigen::Index v = 0; v < scan.positions.rows(); ++v) {
      const int skin = static_cast<int>(test::ScanSet::skin(1.0 - scan.uvs(v, 1), scan.uvs(v, 0)));
      text += fmt::format("{} {} {} {} {} {}\n", scan.positions(v, 0), scan.positions(v, 1), scan.positions(v, 2), skin,
                          skin / 2, 10);
    }
    for (const auto& t : scan.triangles.rowwise()) text += fmt::format("3 {} {} {}\n", t[0], t[1], t[2]);
    io::writeTextFile(folder / "scans" / (std::string(name) + ".ply"), text);
  }
  RegistrationOptions options;
  options.resolution = kSide;
  options.unit = "cm";
  options.last_step = RegistrationStep::kBending;
  Notes notes;
  registerScans(folder / "scans", made.folder / "template", folder / "capture", options, test::testDevice(), notes);
  const image::Image confidence = image::readImage(folder / "capture/confidence/open.png");
  const image::Image open = image::readImage(folder / "capture/albedo/open.png");
  ASSERT_EQ(open.shape, (image::ImageShape{kSide, kSide, 3, image::SampleType::kUint8}));
  double error = 0.0, contrast = 0.0;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      const auto at = static_cast<std::size_t>(y * kSide + x);
      if (image::sampleAt(confidence, at) < 0.5f) continue;
      const double expected = test::ScanSet::skin((x + 0.5) / kSide, 1.0 - (y + 0.5) / kSide);
      error += std::abs(255.0 * double{image::sampleAt(open, 3 * at)} - expected);
      contrast += std::abs(128.0 - expected);
      EXPECT_NEAR(255.0 * double{image::sampleAt(open, 3 * at + 2)}, 10.0, 1.0);
    }
  }
  EXPECT_GT(contrast, 0.0);
  EXPECT_LT(error, 0.35 * contrast);
}

TEST(Registration, TheHeadsMotionIsTakenOutAndTold) {
  const RegisteredScan& open = Registered::once().report.scans[1];
  EXPECT_NEAR(open.degrees, (0.03 + 0.05) * 180.0 / 3.14159265, 0.7);
  EXPECT_GT(open.millimetres, 5.0);
}

TEST(Registration, ReportsAsJson) {
  const nlohmann::json report = nlohmann::json::parse(toJson(Registered::once().report));
  EXPECT_EQ(report["facezip_report"], "register");
  EXPECT_EQ(report["scans"].size(), 2u);
  EXPECT_EQ(report["scans"][1]["name"], "open");
  EXPECT_GT(report["scans"][1]["head_motion"]["degrees"].get<double>(), 1.0);
  EXPECT_GE(report["scans"][1]["flow_texels"]["rounds"].get<int>(), 1);
  EXPECT_GE(report["flow_side"].get<int>(), 256);
}

TEST(Registration, EachScanHasItsPicture) {
  const Registered& made = Registered::once();
  for (const char* name : {"neutral.png", "open.png"}) {
    const image::Image picture = image::readImage(made.folder / "capture/registration" / name);
    constexpr int kPicture = registration::kPictureSide;
    ASSERT_EQ(picture.shape, (image::ImageShape{3 * kPicture, kPicture, 3, image::SampleType::kUint8}));
    const auto red = [&](int x, int y) {
      return image::sampleAt(picture, 3 * static_cast<std::size_t>(y * 3 * kPicture + x));
    };
    int near = 0;
    for (int y = kPicture / 3; y < 2 * kPicture / 3; ++y) {
      for (int x = kPicture / 3; x < 2 * kPicture / 3; ++x) near += red(kPicture + x, y) < 0.35f ? 1 : 0;
    }
    EXPECT_GT(near, kPicture * kPicture / 12) << "the mesh lies on its scan";
  }
}

TEST(RegistrationPicture, ShowsEdgesDistancesAndTexture) {
  const geometry::TriangleMesh mesh = test::gridMesh(3, 0.0);
  std::vector<int> region(static_cast<std::size_t>(mesh.triangles.rows()));
  std::iota(region.begin(), region.end(), 0);
  registration::BakedTexture texture;
  texture.side = 2;
  texture.channels = 3;
  for (const float grey : {0.1f, 0.2f, 0.3f, 0.4f}) texture.samples.insert(texture.samples.end(), 3, grey);
  std::vector<float> distances(9, 0.0f);
  distances[8] = 1.0f;           // the upper right corner
  distances[0] = std::nanf("");  // the lower left one
  const image::Image picture = registration::pictureOf(registration::frontOf(mesh, mesh.positions, region), mesh,
                                                       mesh.positions, distances, texture);
  constexpr int kPicture = registration::kPictureSide;
  // Places of the patch, which fills the picture's height: 0.25 high, 0.2 wide.
  const auto at = [&](int column, double s, double t) {
    const int x = static_cast<int>(kPicture * (column + 0.5 + 0.92 * 0.8 * (s - 0.5)));
    const int y = static_cast<int>(kPicture * (0.5 - 0.92 * (t - 0.5)));
    return 255.0f * image::sampleAt(picture, 3 * static_cast<std::size_t>(y * 3 * kPicture + x));
  };
  EXPECT_NEAR(at(2, 0.25, 0.75), 255 * 0.1, 1.0);
  EXPECT_NEAR(at(2, 0.75, 0.75), 255 * 0.2, 1.0);
  EXPECT_NEAR(at(2, 0.25, 0.25), 255 * 0.3, 1.0);
  EXPECT_NEAR(at(2, 0.75, 0.25), 255 * 0.4, 1.0);
  EXPECT_GT(at(1, 0.98, 0.98), 230.0f) << "a millimetre";
  EXPECT_LT(at(1, 0.25, 0.8), 5.0f) << "on the scan";
  EXPECT_NEAR(at(1, 0.05, 0.02), at(1, 0.02, 0.05), 12.0f);
  EXPECT_GT(at(1, 0.05, 0.02), 60.0f) << "nothing shown: grey";
  EXPECT_LT(at(0, 0.5, 0.8), 0.8f * at(0, 0.4, 0.8)) << "an edge beside a face";
  EXPECT_NEAR(at(0, -0.05, 0.5), 255 * 0.2, 1.0) << "beside the mesh";
}

TEST(HoleFilling, KeepsWhatIsKnownAndGoesOnSmoothly) {
  constexpr int kWidth = 37, kHeight = 21;
  std::vector<float> values(kWidth * kHeight * 2, 0.0f);
  std::vector<std::uint8_t> known(kWidth * kHeight, 0);
  const auto truth = [](int x, int y, int c) { return 0.01f * static_cast<float>(c == 0 ? x : 2 * y); };
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      known[static_cast<std::size_t>(y * kWidth + x)] = std::hypot(x - 18, y - 10) > 4.0 ? 1 : 0;
      for (int c = 0; c < 2; ++c) {
        values[static_cast<std::size_t>((y * kWidth + x) * 2 + c)] =
            known[static_cast<std::size_t>(y * kWidth + x)] != 0 ? truth(x, y, c) : 99.0f;
      }
    }
  }
  registration::fillHoles(values, 2, kWidth, kHeight, known);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      for (int c = 0; c < 2; ++c) {
        const bool seen = known[static_cast<std::size_t>(y * kWidth + x)] != 0;
        EXPECT_NEAR(values[static_cast<std::size_t>((y * kWidth + x) * 2 + c)], truth(x, y, c), seen ? 0.0f : 0.07f);
      }
    }
  }
  std::fill(known.begin(), known.end(), std::uint8_t{0});
  registration::fillHoles(values, 2, kWidth, kHeight, known);
  EXPECT_THAT(values, testing::Each(0.0f));
}

}  // namespace
}  // namespace facezip
