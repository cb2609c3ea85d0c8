#include "facezip/rig.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tiny_gltf.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <numeric>

#include "facezip/blend.hpp"
#include "facezip/evaluate.hpp"
#include "facezip/geometry/obj_io.hpp"
#include "facezip/package.hpp"
#include "file_contents.hpp"
#include "image/image_file.hpp"
#include "io/staged_directory.hpp"
#include "notes.hpp"
#include "rig/shape_codes.hpp"
#include "rig/texture_solve.hpp"
#include "rig/weight_guess.hpp"
#include "rig_capture.hpp"
#include "temporary_directory.hpp"
#include "test_device.hpp"

namespace facezip {
namespace {
namespace fs = std::filesystem;
using rig::TextureSolver;

RigOptions quickOptions() {
  RigOptions options;
  options.compress.unit = "m";
  options.compress.mask_radius = geometry::parseLength("5cm");
  options.compress.restarts = 3;
  options.compress.cluster_restarts = 3;
  options.fit.iterations = 4;
  return options;
}

/// A rigged capture, made once.
class RigTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new test::TemporaryDirectory;
    test::writeRigCapture(folder_->path());
    Progress progress;
    report_ = new RigReport(rigCapture(openCapture(folder() / "capture"), folder() / "template", package(),
                                       quickOptions(), test::testDevice(), progress));
  }
  static void TearDownTestSuite() {
    delete report_;
    delete folder_;
  }
  static fs::path folder() { return folder_->path(); }
  static fs::path package() { return folder() / "face.facezip"; }

  static test::TemporaryDirectory* folder_;
  static RigReport* report_;
};

test::TemporaryDirectory* RigTest::folder_ = nullptr;
RigReport* RigTest::report_ = nullptr;

TEST_F(RigTest, BlendsByCapturedNamesAndByShapes) {
  const Package packed = Package::open(package());
  EXPECT_THAT(packed.expressions(), testing::ElementsAre("r0", "r1", "r2", "r3", "bumpA", "bumpB", "bumpC"));
  Blender blender(packed, test::testDevice());
  const auto brightest = [&](const std::string& name, int x, int y) {
    std::vector<std::byte> neutral(packed.maps()[0].frameBytes()), frame(neutral.size());
    blender.setWeights(weightsByName(packed, {}));
    blender.blend(0, neutral);
    blender.setWeights(weightsByName(packed, {{name, 1.0f}}));
    blender.blend(0, frame);
    const auto texel = static_cast<std::size_t>((y * 64 + x) * 3);
    return std::to_integer<int>(frame[texel]) - std::to_integer<int>(neutral[texel]);
  };
  // Centres of the bumps: (0.3, 0.3), (0.7, 0.3), (0.3, 0.75) of the patch, v up; each shows in its own shape only.
  EXPECT_NEAR(brightest("r0", 21, 42), 60, 8);
  EXPECT_GT(brightest("bumpA", 21, 42), 40);
  EXPECT_LT(std::abs(brightest("bumpA", 42, 42)), 6);
  EXPECT_GT(brightest("bumpB", 42, 42), 35);
  EXPECT_LT(std::abs(brightest("bumpB", 21, 42)), 8);
  EXPECT_GT(brightest("bumpC", 21, 19), 35);
}

TEST_F(RigTest, ABudgetHoldsTheWeightsOfTheShapes) {
  RigOptions options = quickOptions();
  options.fit.iterations = 0;
  const std::uint64_t whole = Package::open(package()).bytesInMemory();
  options.compress.budget_bytes = whole - 1;  // as many textures as it would take without the shapes do not fit
  Progress progress;
  const RigReport report = rigCapture(openCapture(folder() / "capture"), folder() / "template", folder() / "small",
                                      options, test::testDevice(), progress);
  ASSERT_TRUE(report.compress.rate);
  EXPECT_LT(Package::open(folder() / "small").bytesInMemory(), whole);
  EXPECT_EQ(Package::open(folder() / "small").bytesInMemory(), report.compress.rate->bytes);
}

/// The capture's neutral alone.
fs::path neutralAlone(const fs::path& folder) {
  fs::create_directories(folder / "neutral/albedo");
  fs::copy_file(folder / "capture/neutral.obj", folder / "neutral/neutral.obj");
  fs::copy_file(folder / "capture/albedo/neutral.png", folder / "neutral/albedo/neutral.png");
  return folder / "neutral";
}

TEST(RigOfANeutralAlone, HasTheTemplatesShapesAndOneTextureOfNothing) {
  const test::TemporaryDirectory folder;
  test::writeRigCapture(folder.path());
  const Capture capture = openCapture(neutralAlone(folder.path()), {}, nullptr, NeutralAlone::kAllowed);
  EXPECT_THROW(openCapture(capture.directory), InputError);
  test::Notes progress;
  RigOptions options = quickOptions();
  options.fit.transfer = geometry::ShapeTransfer::kDisplacements;
  const RigReport report =
      rigCapture(capture, folder / "template", folder / "face", options, test::testDevice(), progress);
  EXPECT_THAT(progress.all, testing::Contains(testing::HasSubstr("the template has no textures")));
  EXPECT_TRUE(report.expressions.empty());
  const Package package = Package::open(folder / "face");
  EXPECT_THAT(package.expressions(), testing::ElementsAre("bumpA", "bumpB", "bumpC"));
  EXPECT_EQ(package.differences(), 1);
  const Rig rig = openRig(package);
  EXPECT_TRUE(rig.weights.empty());
  EXPECT_EQ(rig.shapes.size(), 3u);
  const geometry::TriangleMesh neutral = geometry::readObj(folder / "face/shapes/neutral.obj");
  const geometry::TriangleMesh shape = geometry::readObj(folder / "face/shapes/bumpB.obj");
  const Eigen::MatrixX3d moved = shape.positions - neutral.positions;
  EXPECT_GT(moved.norm(), 0.8 * test::templateShape(1).norm());
  EXPECT_LT((moved - test::templateShape(1)).norm(), 0.2 * moved.norm());  // the patches differ in width
  // It poses meshes like any rig.
  const SolvedClip clip = solveWeights(folder / "face", {folder / "face/shapes/bumpC.obj"}, {}, progress);
  EXPECT_NEAR(clip.weights[0][2], 1.0, 1e-3);
}

TEST(RigOfANeutralAlone, GetsTheTemplatesTextures) {
  const test::TemporaryDirectory folder;
  test::writeRigCapture(folder.path());
  const Capture capture = openCapture(neutralAlone(folder.path()), {}, nullptr, NeutralAlone::kAllowed);
  // Half the subject's size, and of one shape alone: brighter by 40 on the left.
  const image::ImageShape shape{32, 32, 3, image::SampleType::kUint8};
  fs::create_directories(folder / "template/albedo");
  image::writeImage(folder / "template/albedo/neutral.png",
                    test::makeImage(shape, [](int, int, int) { return 100.0; }));
  image::writeImage(folder / "template/albedo/bumpA.png",
                    test::makeImage(shape, [](int x, int, int) { return x < 16 ? 140.0 : 100.0; }));
  Progress progress;
  rigCapture(capture, folder / "template", folder / "face", quickOptions(), test::testDevice(), progress);
  const Package package = Package::open(folder / "face");
  Blender blender(package, test::testDevice());
  const auto changeAt = [&](const std::string& name, std::size_t x) {
    std::vector<std::byte> neutral(package.maps()[0].frameBytes()), frame(neutral.size());
    blender.setWeights(weightsByName(package, {}));
    blender.blend(0, neutral);
    blender.setWeights(weightsByName(package, {{name, 1.0f}}));
    blender.blend(0, frame);
    const std::size_t texel = (32 * 64 + x) * 3;
    return std::to_integer<int>(frame[texel]) - std::to_integer<int>(neutral[texel]);
  };
  EXPECT_NEAR(changeAt("bumpA", 20), 40, 2);
  EXPECT_NEAR(changeAt("bumpA", 44), 0, 2);
  EXPECT_NEAR(changeAt("bumpB", 20), 0, 2);
}

TEST_F(RigTest, ShapesAreTheSubjectsAndWeightsAreRecovered) {
  const geometry::TriangleMesh neutral = geometry::readObj(package() / "shapes/neutral.obj");
  for (int m = 0; m < 3; ++m) {
    const geometry::TriangleMesh shape =
        geometry::readObj(package() / "shapes" / (std::string(test::kRigShapes[m]) + ".obj"));
    const Eigen::MatrixX3d truth = test::rigShape(test::kRigSide, m, 0.03);
    const Eigen::MatrixX3d by_template = test::templateShape(m);
    EXPECT_LT((shape.positions - neutral.positions - truth).norm(), 0.9 * (by_template - truth).norm()) << m;
  }
  for (std::size_t n = 0; n < 4; ++n) {
    EXPECT_LT(report_->residuals[n].mean, report_->template_residuals[n].mean + 0.005);
    for (std::size_t m = 0; m < 3; ++m) EXPECT_NEAR(report_->weights[n][m], test::kRigWeights[n][m], 0.2);
  }
  EXPECT_EQ(report_->texture_rank, 3);
  EXPECT_LT(report_->left_out_rmse, 0.6 * report_->left_out_nothing);
}

TEST_F(RigTest, TheGltfNamesItsTargets) {
  const std::string text = test::contentsOf(package() / "rig.gltf");
  for (const char* name : test::kRigShapes) EXPECT_THAT(text, testing::HasSubstr(name));
  EXPECT_THAT(text, testing::HasSubstr("albedo/neutral.png"));
}

TEST_F(RigTest, ThePackagesMeshIsPosedByExpressionsAndShapes) {
  const Package packed = Package::open(package());
  tinygltf::Model model;
  std::string error, warning;
  const std::string file = (package() / packed.description().mesh_file).string();
  ASSERT_TRUE(tinygltf::TinyGLTF().LoadBinaryFromFile(&model, &error, &warning, file)) << error;
  const tinygltf::Value names = model.meshes.at(0).extras.Get("targetNames");
  std::vector<std::string> targets;
  for (std::size_t t = 0; t < names.ArrayLen(); ++t)
    targets.push_back(names.Get(static_cast<int>(t)).Get<std::string>());
  EXPECT_EQ(targets, packed.expressions());
  // Shapes move it as far as they move shapes/NAME.obj.
  const geometry::TriangleMesh neutral = geometry::readObj(package() / "shapes/neutral.obj");
  const tinygltf::Primitive& primitive = model.meshes[0].primitives.at(0);
  for (std::size_t m = 0; m < 3; ++m) {
    const geometry::TriangleMesh shape =
        geometry::readObj(package() / "shapes" / (std::string(test::kRigShapes[m]) + ".obj"));
    const tinygltf::Accessor& moved =
        model.accessors.at(static_cast<std::size_t>(primitive.targets.at(4 + m).at("POSITION")));
    const Eigen::RowVector3d most = (shape.positions - neutral.positions).colwise().maxCoeff();
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_NEAR(moved.maxValues.at(c), std::max(most(static_cast<Eigen::Index>(c)), 0.0), 1e-5) << m;
    }
  }
}

TEST_F(RigTest, IsEvaluatedByItsOwnNamesAndThroughTheShapes) {
  EvaluateOptions options;
  options.methods = {};
  options.baselines = {};
  Progress progress;
  const Package packed = Package::open(package());
  const Evaluation evaluation =
      evaluatePackage(openCapture(folder() / "capture"), packed, options, test::testDevice(), progress);
  const auto& rmse = evaluation.maps[0].rmse;
  EXPECT_EQ(evaluation.expressions.size(), 4u);
  EXPECT_LT(rmse.at("package").pooled, 1.0);
  // Shapes take next to nothing from what was captured.
  EXPECT_NEAR(rmse.at("package").pooled, report_->compress.rmse.front().second, 0.05);
  EXPECT_LT(rmse.at("rig").pooled, 0.35 * evaluation.maps[0].rms_difference);
  EXPECT_GE(rmse.at("rig").pooled, rmse.at("package").pooled);
  options.shapes = true;  // no expression of the capture is a shape
  EXPECT_THROW(evaluatePackage(openCapture(folder() / "capture"), packed, options, test::testDevice(), progress),
               InputError);
}

TEST_F(RigTest, WeightsOfTrackedMeshesAreFound) {
  Progress progress;
  std::vector<fs::path> meshes;
  for (const char* name : {"r0", "r1", "r2", "r3"}) {
    meshes.push_back(folder() / "capture/expressions" / (std::string(name) + ".obj"));
  }
  const SolvedClip clip = solveWeights(package(), meshes, {}, progress);
  for (std::size_t n = 0; n < 4; ++n) {
    for (std::size_t m = 0; m < 3; ++m) EXPECT_NEAR(clip.weights[n][m], report_->weights[n][m], 0.05) << n << ' ' << m;
    EXPECT_LE(clip.residuals[n].mean, report_->residuals[n].mean + 0.05);
  }
  // In millimetres.
  geometry::TriangleMesh mesh = geometry::readObj(meshes[0]);
  mesh.positions *= 1000.0;
  geometry::writeObj(folder() / "millimetres.obj", mesh);
  EXPECT_THROW(solveWeights(package(), {folder() / "millimetres.obj"}, {}, progress), InputError);
  writeClip(folder() / "clip.csv", clip);
  const AnimationClip read = readAnimation(folder() / "clip.csv", Package::open(package()));
  EXPECT_EQ(read.frames(), 4);
  EXPECT_NEAR(read.frame(1)[5], clip.weights[1][1], 1e-5);
}

TEST_F(RigTest, AClipCountsNoFramesUnderANameOfThePackage) {
  Progress progress;
  const fs::path other = folder() / "frame.facezip";
  fs::copy(package(), other, fs::copy_options::recursive);
  for (const char* file : {"package.json", "rig.json"}) {
    std::string text = test::contentsOf(other / file);
    for (std::size_t at = text.find("\"r0\""); at != std::string::npos; at = text.find("\"r0\"", at)) {
      text.replace(at, 4, "\"frame\"");
    }
    io::writeTextFile(other / file, text);
  }
  const std::vector<fs::path> meshes(3, folder() / "capture/expressions/r1.obj");
  const SolvedClip clip = solveWeights(other, meshes, {}, progress);
  writeClip(folder() / "frame.csv", clip);
  const AnimationClip read = readAnimation(folder() / "frame.csv", Package::open(other));
  EXPECT_EQ(read.frames(), 3);
  EXPECT_EQ(read.frame(2)[0], 0.0f) << "the number of the frame is no weight";
  EXPECT_NEAR(read.frame(2)[5], clip.weights[2][1], 1e-5);
}

TEST_F(RigTest, SmoothingCalmsAClipAndHeadMotionIsTakenOut) {
  Progress progress;
  const fs::path frames = folder() / "frames";
  fs::create_directories(frames);
  const geometry::TriangleMesh neutral = geometry::readObj(folder() / "capture/neutral.obj");
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitY()).matrix();
  std::vector<fs::path> still, moving;
  for (int f = 0; f < 8; ++f) {
    geometry::TriangleMesh mesh = neutral;
    mesh.positions += (f % 2 == 0 ? 0.2 : 0.6) * test::rigShape(test::kRigSide, 0, 0.03);
    still.push_back(frames / ("s" + std::to_string(f) + ".obj"));
    geometry::writeObj(still.back(), mesh);
    mesh.positions = (mesh.positions * turn.transpose()).rowwise() + Eigen::RowVector3d(0.1, 0.2, -0.3);
    moving.push_back(frames / ("m" + std::to_string(f) + ".obj"));
    geometry::writeObj(moving.back(), mesh);
  }
  const auto jumps = [](const SolvedClip& clip) {
    double sum = 0.0;
    for (std::size_t f = 1; f < clip.weights.size(); ++f) sum += std::abs(clip.weights[f][0] - clip.weights[f - 1][0]);
    return sum;
  };
  const SolvedClip plain = solveWeights(package(), still, {}, progress);
  const SolvedClip smooth = solveWeights(package(), still, {.smoothing = 1.0}, progress);
  EXPECT_LT(jumps(smooth), 0.6 * jumps(plain));
  EXPECT_GT(smooth.residuals[0].mean, plain.residuals[0].mean);
  const SolvedClip followed = solveWeights(package(), moving, {.head_motion = true}, progress);
  for (std::size_t f = 0; f < 8; ++f) EXPECT_NEAR(followed.weights[f][0], plain.weights[f][0], 0.05) << f;
  EXPECT_LT(followed.residuals[0].mean, 1.0);
}

TEST_F(RigTest, TheSameInputGivesTheSameBytes) {
  Progress progress;
  rigCapture(openCapture(folder() / "capture"), folder() / "template", folder() / "again", quickOptions(),
             test::testDevice(), progress);
  for (const char* name : {"package.json", "weights.png", "rig.json", "rig.bin", "shapes/bumpB.obj"}) {
    EXPECT_EQ(test::contentsOf(folder() / "again" / name), test::contentsOf(package() / name)) << name;
  }
}

/// Two expressions of other textures whose meshes are nearly alike: the pseudo-inverse blows up.
TEST_F(RigTest, ShapesThatNothingDeterminesDoNotHarmWhatWasCaptured) {
  struct Notes : Progress {
    void note(std::string_view message) override { text += message; }
    std::string text;
  } progress;
  fs::copy(folder() / "capture", folder() / "alike", fs::copy_options::recursive);
  geometry::TriangleMesh mesh = geometry::readObj(folder() / "capture/neutral.obj");
  const Eigen::MatrixX3d neutral = mesh.positions;
  for (const char* other : {"r2", "r3"}) {
    fs::remove(folder() / "alike/expressions" / (std::string(other) + ".obj"));
    fs::remove(folder() / "alike/albedo" / (std::string(other) + ".png"));
  }
  for (const auto& [name, weight] : {std::pair("r0", 0.0), std::pair("r1", 0.03)}) {
    mesh.positions =
        neutral + 0.6 * test::rigShape(test::kRigSide, 0, 0.03) + weight * test::rigShape(test::kRigSide, 1, 0.03);
    geometry::writeObj(folder() / "alike/expressions" / (std::string(name) + ".obj"), mesh);
  }
  RigOptions options = quickOptions();
  options.fit.iterations = 0;
  options.fit.transfer = geometry::ShapeTransfer::kDisplacements;
  options.texture_solve = TextureSolve::kPseudoInverse;
  const Capture capture = openCapture(folder() / "alike");
  const RigReport report =
      rigCapture(capture, folder() / "template", folder() / "alike.facezip", options, test::testDevice(), progress);
  EXPECT_THAT(progress.text, testing::HasSubstr("are clamped"));
  EvaluateOptions evaluate;
  evaluate.methods = {};
  evaluate.baselines = {};
  const Evaluation evaluation =
      evaluatePackage(capture, Package::open(folder() / "alike.facezip"), evaluate, test::testDevice(), progress);
  EXPECT_NEAR(evaluation.maps[0].rmse.at("package").pooled, report.compress.rmse.front().second, 0.05);
}

/// FaceZip, section 3.2, without further options: W* = B+ W (Eq. 11) is stored whole, and adds up to W (Eq. 10).
TEST_F(RigTest, ThePapersMethodStoresWhatTheEquationsSay) {
  RigOptions options = quickOptions();
  options.compress.method = Method::kPaper;
  options.fit.iterations = 0;
  Progress progress;
  fs::copy(folder() / "capture", folder() / "three", fs::copy_options::recursive);
  fs::remove(folder() / "three/expressions/r2.obj");
  fs::remove(folder() / "three/albedo/r2.png");
  // Nearly alike, so that shapes must go beyond what was captured.
  geometry::TriangleMesh mesh = geometry::readObj(folder() / "capture/neutral.obj");
  mesh.positions += 0.7 * test::rigShape(test::kRigSide, 1, 0.03) + 0.5 * test::rigShape(test::kRigSide, 2, 0.03);
  geometry::writeObj(folder() / "three/expressions/r1.obj", mesh);
  const Capture capture = openCapture(folder() / "three");
  const RigReport report =
      rigCapture(capture, folder() / "template", folder() / "three.facezip", options, test::testDevice(), progress);
  compressCapture(capture, folder() / "plain.facezip", options.compress, test::testDevice(), progress);
  EXPECT_EQ(report.texture_solve, "pseudo-inverse");
  ASSERT_EQ(report.texture_rank, 3);

  Eigen::MatrixXd b(3, 3);
  for (Eigen::Index n = 0; n < 3; ++n) {
    for (Eigen::Index m = 0; m < 3; ++m)
      b(n, m) = report.weights[static_cast<std::size_t>(n)][static_cast<std::size_t>(m)];
  }
  const Package package = Package::open(folder() / "three.facezip");
  const Eigen::MatrixXd captured = rig::decodeSet(Package::open(folder() / "plain.facezip"), 0).cast<double>();
  const Eigen::MatrixXd decoded = rig::decodeSet(package, 0).cast<double>();
  const Eigen::MatrixXd shapes = decoded.rightCols(3);
  const Eigen::MatrixXd expected = captured * b.inverse().transpose();
  EXPECT_GT(expected.maxCoeff(), 1.55) << "more than twice the captured range, or the test tests nothing";
  const auto channels = static_cast<Eigen::Index>(package.differences());
  for (Eigen::Index row = 0; row < decoded.rows(); ++row) {
    const double half_step = 0.5 * package.weightSets()[0].scale[static_cast<std::size_t>(row % channels)] + 1e-5;
    EXPECT_LT((shapes.row(row) - expected.row(row)).cwiseAbs().maxCoeff(), half_step);
    const Eigen::RowVectorXd reproduced = shapes.row(row) * b.transpose();
    for (Eigen::Index n = 0; n < 3; ++n) {
      EXPECT_NEAR(reproduced[n], captured(row, n), half_step * b.row(n).sum() + 1e-5);
    }
  }
}

// ---- the solve by itself

Eigen::MatrixXd someWeights() {
  Eigen::MatrixXd weights(3, 5);
  weights << 1, 0.2, 0, 0, 0.4, 0, 0.7, 0.5, 0, 0, 0.3, 0, 0, 0.9, 0.1;
  return weights;
}

TEST(TextureSolve, PseudoInverseFulfilsTheFourConditionsOfPenrose) {
  for (const bool dependent : {false, true}) {
    Eigen::MatrixXd b = someWeights();
    if (dependent) b.row(2) = 0.5 * b.row(0) + 0.25 * b.row(1);
    EXPECT_EQ(rig::rankOf(b), dependent ? 2 : 3);
    const Eigen::MatrixXd p = rig::globalSolution({TextureSolve::kPseudoInverse, b, 0.0, 0.0});
    EXPECT_LT((b * p * b - b).norm(), 1e-10);
    EXPECT_LT((p * b * p - p).norm(), 1e-10);
    EXPECT_LT((b * p - (b * p).transpose()).norm(), 1e-10);
    EXPECT_LT((p * b - (p * b).transpose()).norm(), 1e-10);
  }
}

TEST(TextureSolve, DampedIsTheRidgeSolution) {
  const Eigen::MatrixXd b = someWeights();
  const Eigen::MatrixXd p = rig::globalSolution({TextureSolve::kDamped, b, 0.3, 0.0});
  // The other form of the same: (B^T B + lambda I)^-1 B^T.
  const Eigen::MatrixXd system = b.transpose() * b + 0.3 * Eigen::MatrixXd::Identity(5, 5);
  EXPECT_LT((system * p - b.transpose()).norm(), 1e-12);
}

TEST(TextureSolve, LocallyAShapeWithoutInfluenceGetsNothing) {
  const Eigen::MatrixXd b = someWeights();
  rig::PointFeatures point;
  point.influence = Eigen::VectorXd::Ones(5);
  point.influence[1] = 0.0;
  point.of_examples = Eigen::MatrixXd::Zero(3, 12);
  point.of_shapes = Eigen::MatrixXd::Zero(5, 12);
  const Eigen::MatrixXd p = rig::localSolution({TextureSolve::kLocal, b, 0.3, 0.1}, point);
  EXPECT_EQ(p.row(1).norm(), 0.0);
  EXPECT_GT(p.row(0).norm(), 0.0);
  point.influence.setOnes();  // alike everywhere: the damped solution
  EXPECT_LT((rig::localSolution({TextureSolve::kLocal, b, 0.3, 0.1}, point) -
             rig::globalSolution({TextureSolve::kDamped, b, 0.3, 0.0}))
                .norm(),
            1e-12);
}

TEST(TextureSolve, LeavingOutByTheInverseIsLeavingOut) {
  const Eigen::MatrixXd b = someWeights();
  rig::SolvedCell cell;
  cell.point.influence = Eigen::VectorXd::LinSpaced(5, 0.2, 1.0);
  cell.point.of_examples = Eigen::MatrixXd::Zero(3, 12);
  cell.point.of_shapes = Eigen::MatrixXd::Zero(5, 12);
  Eigen::MatrixXd textures(3, 4);
  textures << 1, 2, 3, 4, -2, 0, 1, 5, 3, 3, -1, 0;
  cell.gram = textures * textures.transpose();
  const rig::LeftOut found = rig::leaveOneOut({TextureSolve::kLocal, b, 0.0, 0.0}, std::span(&cell, 1), 0.3);
  EXPECT_EQ(found.damping, 0.3);
  // By hand: fit the other two, predict the third.
  double squares = 0.0;
  const Eigen::MatrixXd a = cell.point.influence.asDiagonal();
  for (int n = 0; n < 3; ++n) {
    Eigen::MatrixXd others(2, 5), seen(2, 4);
    for (int i = 0, row = 0; i < 3; ++i) {
      if (i == n) continue;
      others.row(row) = b.row(i);
      seen.row(row++) = textures.row(i);
    }
    const Eigen::MatrixXd system = others * a * others.transpose() + 0.3 * Eigen::MatrixXd::Identity(2, 2);
    const Eigen::MatrixXd predicted = b.row(n) * a * others.transpose() * system.inverse() * seen;
    squares += (predicted - textures.row(n)).squaredNorm();
  }
  EXPECT_NEAR(found.error, squares, 1e-9);
  EXPECT_NEAR(found.nothing, textures.squaredNorm(), 1e-9);
}

// ---- guesses

class GuessTest : public testing::Test {
 protected:
  Eigen::MatrixXd read(const std::string& name, const std::string& text) const {
    io::writeTextFile(folder_ / name, text);
    return rig::readGuess(folder_ / name, {"happy", "sad"}, {"up", "down"});
  }
  void refuses(const std::string& name, const std::string& text, const std::string& part) const {
    try {
      read(name, text);
      ADD_FAILURE() << text;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr(part));
      EXPECT_THAT(error.what(), testing::HasSubstr(name));
    }
  }
  const test::TemporaryDirectory folder_;
};

TEST_F(GuessTest, TablesAndObjectsAreRead) {
  Eigen::MatrixXd expected(2, 2);
  expected << 0.25, 1, 0, 0.5;
  EXPECT_EQ(read("g.csv", "expression,down,up\nsad,0.5,0\nhappy,1,0.25\n"), expected);
  EXPECT_EQ(read("g.json", R"({"happy": {"up": 0.25, "down": 1}, "sad": {"down": 0.5}})"), expected);
  EXPECT_EQ(read("g.csv", "expression,Down,UP\nSad,0.5,0\nhappy,1,0.25\n"), expected) << "names of one shape";
}

TEST_F(GuessTest, AShapeDrivenBeyondOneIsFullyOn) {
  io::writeTextFile(folder_ / "g.csv", "expression,up,down\nhappy,1.18,0.5\nsad,0,0\n");
  EXPECT_EQ(rig::readGuess(folder_ / "g.csv", {"happy", "sad"}, {"up", "down"})(0, 0), 1.0);
}

TEST_F(GuessTest, BadOnesAreRefused) {
  refuses("g.csv", "expression,up,sideways\nhappy,0,0\nsad,0,0\n", "sideways");
  refuses("g.csv", "expression,up,Up\nhappy,0,0\nsad,0,0\n", "each shape once");
  refuses("g.json", R"({"happy": {"up": 0.25, "Up": 1}, "sad": {}})", "each shape once");
  refuses("g.csv", "expression,up,down\nhappy,0,50\nsad,0,0\n", "from 0 to 1");
  refuses("g.csv", "expression,up,down\nhappy,0,nan\nsad,0,0\n", "from 0 to 1");
  refuses("g.csv", "expression,up,down\nhappy,0\nsad,0,0\n", "3 columns");
  refuses("g.csv", "expression,up,down\nhappy,0,0\n", "sad");
  refuses("g.csv", "expression,up,down\nhappy,0,0\nhappy,0,0\n", "twice");
  refuses("g.csv", "expression,up,up\nhappy,0,0\nsad,0,0\n", "twice");
  refuses("g.json", R"({"happy": {"upp": 0.25}, "sad": {}})", "nearest is up");
  refuses("g.json", R"({"hapy": {}, "sad": {}})", "nearest is happy");
  refuses("g.json", R"({"happy": {"up": -0.1}, "sad": {}})", "from 0 to 1");
  refuses("g.json", R"([1, 2])", "object");
  refuses("g.txt", "x", ".csv or .json");
}

}  // namespace
}  // namespace facezip
