#include "facezip/learn.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "facezip/blend.hpp"
#include "facezip/geometry/deformation_transfer.hpp"
#include "facezip/geometry/obj_io.hpp"
#include "facezip/package.hpp"
#include "facezip/registration.hpp"
#include "facezip/synth.hpp"
#include "file_contents.hpp"
#include "learn/face_model.hpp"
#include "learn_library.hpp"
#include "scan_set.hpp"
#include "temporary_directory.hpp"
#include "test_device.hpp"

namespace facezip {
namespace {
namespace fs = std::filesystem;
using testing::HasSubstr;

CompressOptions quickOptions() {
  CompressOptions options;
  options.mask_radius = geometry::parseLength("5cm");
  options.restarts = 3;
  options.cluster_restarts = 3;
  return options;
}

/// A library of seven, learned once.
class LearnTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new test::TemporaryDirectory;
    test::writeLearnLibrary(folder(), 7);
    report_ = new TrainReport(train("model"));
  }
  static void TearDownTestSuite() {
    delete report_;
    delete folder_;
  }
  static fs::path folder() { return folder_->path(); }
  static TrainReport train(const std::string& model, const fs::path& library = folder() / "library") {
    TrainOptions options;
    options.resolution = 64;
    Progress progress;
    return trainModel(library, folder() / "library/template", folder() / "library/facs.json", folder() / model, options,
                      progress);
  }
  static GenerateReport generate(const fs::path& neutral, const fs::path& model, const std::string& package) {
    Progress progress;
    return generateFace(openCapture(neutral, {}, nullptr, NeutralAlone::kAllowed), model, folder() / package,
                        {quickOptions(), ""}, test::testDevice(), progress);
  }
  template <typename Work>
  static std::string refusalOf(const Work& work) {
    try {
      work();
    } catch (const InputError& error) {
      return error.what();
    }
    return "not refused";
  }

  static test::TemporaryDirectory* folder_;
  static TrainReport* report_;
};

test::TemporaryDirectory* LearnTest::folder_ = nullptr;
TrainReport* LearnTest::report_ = nullptr;

TEST_F(LearnTest, AStrangersShapesAreHerOwnAndSoAreTheirTextures) {
  EXPECT_EQ(report_->subjects, 7u);
  EXPECT_LT(report_->left_out_mm, 0.7 * report_->template_mm);
  EXPECT_LT(report_->textures.at(0).error, 0.8 * report_->textures.at(0).nothing);
  const GenerateReport report = generate(folder() / "stranger", folder() / "model", "face");
  EXPECT_THAT(report.maps, testing::ElementsAre("albedo"));
  EXPECT_LT(report.strangeness, 2.0);
  const geometry::TriangleMesh neutral = geometry::readObj(folder() / "face/shapes/neutral.obj");
  double error = 0.0, by_template = 0.0;
  for (int m = 0; m < 3; ++m) {
    const geometry::TriangleMesh shape =
        geometry::readObj(folder() / "face/shapes" / (std::string(test::kRigShapes[m]) + ".obj"));
    const Eigen::MatrixX3d truth = test::strengthOf(1.1) * test::templateShape(m);
    error += (shape.positions - neutral.positions - truth).norm();
    by_template += (test::templateShape(m) - truth).norm();
  }
  EXPECT_LT(error, 0.7 * by_template);

  const Package package = Package::open(folder() / "face");
  EXPECT_THAT(package.expressions(), testing::ElementsAre("bumpA", "bumpB", "bumpC"));
  Blender blender(package, test::testDevice());
  const auto changeAt = [&](const std::string& name, std::size_t x, std::size_t y) {
    std::vector<std::byte> rest(package.maps()[0].frameBytes()), frame(rest.size());
    blender.setWeights(weightsByName(package, {}));
    blender.blend(0, rest);
    blender.setWeights(weightsByName(package, {{name, 1.0f}}));
    blender.blend(0, frame);
    const std::size_t texel = (y * 64 + x) * 3;
    return std::to_integer<int>(frame[texel]) - std::to_integer<int>(rest[texel]);
  };
  EXPECT_LT(changeAt("bumpA", 21, 42), -15);  // 40 at the top of the bump, (0.3, 0.3) of the patch
  EXPECT_LT(std::abs(changeAt("bumpA", 42, 42)), 5);
  EXPECT_LT(changeAt("bumpB", 42, 42), -15);
}

TEST_F(LearnTest, TheSameAgainHasTheSameBytes) {
  train("again");
  EXPECT_EQ(test::contentsOf(folder() / "model"), test::contentsOf(folder() / "again"));
}

TEST_F(LearnTest, AModelComesBackAsItWasWritten) {
  const learn::FaceModel model = learn::readModel(folder() / "model");
  Progress progress;
  learn::writeModel(folder() / "copy", model, progress);
  EXPECT_EQ(test::contentsOf(folder() / "model"), test::contentsOf(folder() / "copy"));
}

TEST_F(LearnTest, MapsThatTheModelDoesNotKnowStayAsTheyAre) {
  fs::copy(folder() / "stranger", folder() / "shiny", fs::copy_options::recursive);
  fs::copy(folder() / "shiny/albedo", folder() / "shiny/roughness");
  EXPECT_THAT(generate(folder() / "shiny", folder() / "model", "shiny_face").left_alone,
              testing::ElementsAre("roughness"));
}

TEST_F(LearnTest, ANeutralInItsOwnPlaceAndUnitGetsTheSameShapes) {
  const fs::path moved = folder() / "moved";
  fs::copy(folder() / "stranger", moved, fs::copy_options::recursive);
  geometry::TriangleMesh mesh = geometry::readObj(moved / "neutral.obj");
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.4, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  mesh.positions = (100.0 * mesh.positions * turn.transpose()).rowwise() + Eigen::RowVector3d(5, 6, 7);
  geometry::writeObj(moved / "neutral.obj", mesh);
  io::writeTextFile(moved / "capture.json", "{\"unit\": \"cm\"}");
  generate(folder() / "stranger", folder() / "model", "here");
  generate(moved, folder() / "model", "there");
  const auto moves = [](const fs::path& package) -> Eigen::MatrixX3d {
    return geometry::readObj(package / "shapes/bumpB.obj").positions -
           geometry::readObj(package / "shapes/neutral.obj").positions;
  };
  const Eigen::MatrixX3d here = moves(folder() / "here");
  EXPECT_LT((moves(folder() / "there") - 100.0 * here * turn.transpose()).norm(), 1e-3 * 100.0 * here.norm());
}

TEST_F(LearnTest, AnotherTopologyIsRefusedAndNamed) {
  const fs::path other = folder() / "other";
  fs::copy(folder() / "stranger", other, fs::copy_options::recursive);
  geometry::writeObj(other / "neutral.obj", test::gridMesh(9));
  const std::string refusal = refusalOf([&] { generate(other, folder() / "model", "none"); });
  EXPECT_THAT(refusal, testing::AllOf(HasSubstr("neutral.obj"), HasSubstr("441"), HasSubstr("81"), HasSubstr("model")));
  EXPECT_FALSE(fs::exists(folder() / "none"));
}

TEST_F(LearnTest, LibrariesThatSayTooLittleAreRefused) {
  const fs::path small = folder() / "small";
  test::writeLearnSubject(small / "subjects/only", 1.0);
  EXPECT_THAT(refusalOf([&] { train("m", small); }), HasSubstr("at least two people"));
  test::writeLearnSubject(small / "subjects/second", 1.1);
  fs::remove(small / "subjects/second/albedo/upper.png");
  fs::remove(small / "subjects/second/expressions/upper.obj");
  EXPECT_THAT(refusalOf([&] { train("m", small); }),
              testing::AllOf(HasSubstr("second"), HasSubstr("\"upper\""), HasSubstr("complete the subject")));
  EXPECT_THAT(refusalOf([&] { train("m", folder() / "nowhere"); }), HasSubstr("no such directory"));
  EXPECT_FALSE(fs::exists(folder() / "m"));
}

TEST_F(LearnTest, BrokenModelsAreRefused) {
  const std::string whole = test::contentsOf(folder() / "model");
  const auto refused = [&](const std::string& bytes) {
    io::writeTextFile(folder() / "broken", bytes);
    return refusalOf([&] { learn::readModel(folder() / "broken"); });
  };
  EXPECT_THAT(refused(""), HasSubstr("`facezip train` wrote"));
  EXPECT_THAT(refused("PK\x03\x04 a pickle of somebody's"), HasSubstr("`facezip train` wrote"));
  for (std::size_t size = 8; size < whole.size(); size += 1 + whole.size() / 97) {
    EXPECT_NE(refused(whole.substr(0, size)), "not refused") << size;
  }
  EXPECT_THAT(refused(whole + "x"), HasSubstr("as their shapes say"));
  std::string other = whole;
  other[8] = 9;
  EXPECT_THAT(refused(other), HasSubstr("version"));
  other = whole;
  other.replace(whole.size() - 4, 4, "\xff\xff\xff\x7f", 4);  // NaN, of the slopes or the polygons
  EXPECT_NE(refused(other), "not refused");
}

// register, then generate: a raw scan of somebody's neutral, of another layout, place and unit, and nothing else of
// hers.
TEST(LearnScanTest, ARawScanBecomesAFaceInTwoSteps) {
  const test::TemporaryDirectory folder;
  Progress progress;
  for (int person = 1; person <= 3; ++person) {
    SynthOptions synth;
    synth.resolution = 64;
    synth.expressions = 12;
    synth.maps = {"albedo"};
    synth.seed = static_cast<std::uint64_t>(person);
    synth.rig_template = person == 1;
    synthesizeCapture(folder / "library" / std::to_string(person), synth, progress);
  }
  TrainOptions train;
  train.resolution = 64;
  train.rounds = 1;
  const fs::path first = folder / "library/1";
  trainModel(folder / "library", first / "template", first / "weights.json", folder / "model", train, progress);

  const test::ScanSet stranger;
  stranger.write(folder / "scans", folder / "template");
  fs::remove(folder / "scans/scans/open.obj");  // the neutral alone
  RegistrationOptions registration;
  registration.resolution = 64;
  registration.unit = "cm";
  registerScans(folder / "scans", folder / "template", folder / "capture", registration, test::testDevice(), progress);
  const Capture neutral = openCapture(folder / "capture", {}, nullptr, NeutralAlone::kAllowed);
  EXPECT_TRUE(neutral.expressions.empty());
  GenerateOptions options;
  options.compress = quickOptions();
  const GenerateReport report =
      generateFace(neutral, folder / "model", folder / "face", options, test::testDevice(), progress);
  EXPECT_LT(report.strangeness, 3.0);
  EXPECT_EQ(report.rig.shapes.size(), 42u);

  // Her own jaw, as the head that was scanned opens it.
  const geometry::TriangleMesh rest = geometry::readObj(folder / "face/shapes/neutral.obj");
  const Eigen::MatrixX3d truth = stranger.truth(0.0);
  const Eigen::MatrixX3d opened = geometry::readObj(folder / "face/shapes/jawOpen.obj").positions - rest.positions +
                                  geometry::readObj(folder / "face/shapes/browInnerUp.obj").positions - rest.positions;
  const geometry::Similarity back = geometry::fitSimilarity(rest.positions, truth);
  const Eigen::MatrixX3d moved = back.applyToVectors(opened), goal = stranger.truth(1.0) - truth;
  EXPECT_LT((moved - goal).norm(), 0.25 * goal.norm());
  EXPECT_NEAR(back.scale, 0.01, 2e-4);  // centimetres to metres
}

}  // namespace
}  // namespace facezip
