// Bad templates, guesses, captures and clips: one clear error, the right exit code, nothing left behind.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "exit_codes.hpp"
#include "facezip/printable.hpp"
#include "file_contents.hpp"
#include "io/staged_directory.hpp"
#include "rig_capture.hpp"
#include "run_command.hpp"
#include "temporary_directory.hpp"

namespace facezip {
namespace {
namespace fs = std::filesystem;
using test::quoted;
using test::runFacezip;
using testing::HasSubstr;

class RigBadInput : public testing::Test {
 protected:
  void SetUp() override { test::writeRigCapture(folder_.path()); }

  fs::path capture() const { return folder_ / "capture"; }
  fs::path shapes() const { return folder_ / "template"; }
  fs::path package() const { return folder_ / "package"; }

  test::CommandResult rig(const std::string& options = "") const {
    return runFacezip("rig " + quoted(capture()) + " --template " + quoted(shapes()) + " --output " +
                      quoted(package()) + " --unit m --mask-radius 5cm --iterations 2 --restarts 2 " + options);
  }

  void expectFailure(int exit_code, const std::vector<std::string>& parts, const std::string& options = "") const {
    const auto files = test::filesBelow(folder_.path());
    const test::CommandResult result = rig(options);
    EXPECT_EQ(result.exit_code, exit_code) << result.error;
    for (const std::string& part : parts) EXPECT_THAT(result.error, HasSubstr(part));
    EXPECT_THAT(result.error, HasSubstr("facezip: error: "));
    EXPECT_EQ(result.out, "");
    EXPECT_EQ(test::filesBelow(folder_.path()), files) << "something was left behind";
  }

  /// Replaces the first line of a file that begins with `start`.
  static void spoilLine(const fs::path& file, const std::string& start, const std::string& line) {
    std::ifstream in(file);
    std::ostringstream text;
    bool done = false;
    for (std::string each; std::getline(in, each);) {
      const bool here = !done && each.starts_with(start);
      done = done || here;
      text << (here ? line : each) << '\n';
    }
    in.close();
    ASSERT_TRUE(done);
    io::writeTextFile(file, text.str());
  }

  void writeGuess(const std::string& text) const { io::writeTextFile(folder_ / "guess.csv", text); }

  const test::TemporaryDirectory folder_;
};

TEST_F(RigBadInput, GoodInputIsTakenAndTold) {
  fs::rename(shapes() / "bumpC.obj", shapes() / "bumpC.OBJ");
  writeGuess("expression,bumpA,bumpB,bumpC\nr0,1,0,0\nr1,0,0.7,0.4\nr2,0.5,0.5,0\nr3,0,0.1,1\n");
  const test::CommandResult result =
      rig("--weights " + quoted(folder_ / "guess.csv") + " --report " + quoted(folder_ / "r.json"));
  EXPECT_EQ(result.exit_code, cli::kExitSuccess) << result.error;
  EXPECT_THAT(result.out, HasSubstr("template alone"));
  EXPECT_TRUE(fs::exists(package() / "shapes/bumpC.obj"));
  EXPECT_TRUE(fs::exists(package() / "rig.gltf"));
  const test::CommandResult solved =
      runFacezip("solve-weights " + quoted(package()) + " " + quoted(capture() / "expressions") + " --output " +
                 quoted(folder_ / "clip.csv"));
  EXPECT_EQ(solved.exit_code, cli::kExitSuccess) << solved.error;
  EXPECT_EQ(runFacezip("blend " + quoted(package()) + " --animation " + quoted(folder_ / "clip.csv") + " --output " +
                       quoted(folder_ / "%d.png"))
                .exit_code,
            cli::kExitSuccess);
  EXPECT_TRUE(fs::exists(folder_ / "3.png"));
}

TEST_F(RigBadInput, TemplateOfAnotherTopology) {
  geometry::writeObj(shapes() / "neutral.obj", test::gridMesh(20));
  expectFailure(cli::kExitInput, {"template/bump", "number of vertices", "400", "441"});
  for (const char* name : test::kRigShapes) {
    geometry::writeObj(shapes() / (std::string(name) + ".obj"), test::gridMesh(20));
  }
  expectFailure(cli::kExitInput, {"neutral.obj", "number of vertices", "400", "441"});
}

TEST_F(RigBadInput, TemplateWithOtherTriangles) {
  for (const char* name : {"neutral", "bumpA", "bumpB", "bumpC"}) {
    geometry::TriangleMesh mesh = geometry::readObj(shapes() / (std::string(name) + ".obj"));
    mesh.triangles.row(7).swap(mesh.triangles.row(8));
    mesh.uv_triangles.row(7).swap(mesh.uv_triangles.row(8));
    geometry::writeObj(shapes() / (std::string(name) + ".obj"), mesh);
  }
  expectFailure(cli::kExitInput, {"template/neutral.obj", "triangle 7"});
}

TEST_F(RigBadInput, AShapeWithNaN) {
  spoilLine(shapes() / "bumpB.obj", "v ", "v 0 nan 0");
  expectFailure(cli::kExitInput, {"bumpB.obj"});
}

TEST_F(RigBadInput, NoTemplateNoNeutralNoShapes) {
  for (const char* name : test::kRigShapes) fs::remove(shapes() / (std::string(name) + ".obj"));
  expectFailure(cli::kExitInput, {"an OBJ file for each shape"});
  fs::remove(shapes() / "neutral.obj");
  expectFailure(cli::kExitInput, {"neutral.obj, generic_neutral.obj or generic_neutral_mesh.obj"});
  fs::remove(shapes());
  expectFailure(cli::kExitInput, {"no such directory"});
}

TEST_F(RigBadInput, ShapesWhoseNamesAPackageCannotHold) {
  const fs::path shape = shapes() / "bumpB.obj";
  for (const std::string& name :
       {std::string("bump,B"), std::string("bump\tB"), std::string(201, 'b'), std::string("b\xff")}) {
    const fs::path renamed = shapes() / (name + ".obj");
    fs::rename(shape, renamed);
    expectFailure(cli::kExitInput, {printable(renamed.string()) + ": shape: expected a name ", "rename the file"});
    fs::rename(renamed, shape);
  }
  // A captured expression gives way to the shape of its name, and may get too long by that.
  const std::string name(195, 'b');
  fs::rename(shape, shapes() / (name + ".obj"));
  for (const fs::path& below : {capture() / "expressions", capture() / "albedo"}) {
    const std::string extension = below.filename() == "albedo" ? ".png" : ".obj";
    fs::rename(below / ("r1" + extension), below / (name + extension));
  }
  expectFailure(cli::kExitInput, {"_captured", "at most 200 bytes", "rename the shape or the expression"});
}

TEST_F(RigBadInput, TwoNeutrals) {
  fs::copy(shapes() / "neutral.obj", shapes() / "generic_neutral.obj");
  expectFailure(cli::kExitInput, {"one neutral"});
}

TEST_F(RigBadInput, AnExpressionWithoutMesh) {
  fs::remove(capture() / "expressions/r1.obj");
  expectFailure(cli::kExitInput, {"r1.obj", "no such file"});
}

TEST_F(RigBadInput, GuessesWithUnknownNamesOrOutOfRange) {
  const std::string weights = "--weights " + quoted(folder_ / "guess.csv");
  writeGuess("expression,bumpX\nr0,1\nr1,0\nr2,0\nr3,0\n");
  expectFailure(cli::kExitInput, {"guess.csv", "bumpX", "nearest"}, weights);
  writeGuess("expression,bumpA\nr0,120\nr1,0\nr2,0\nr3,0\n");
  expectFailure(cli::kExitInput, {"guess.csv", "line 2", "from 0 to 1", "120"}, weights);
  writeGuess("expression,bumpA\nr0,1\n");
  expectFailure(cli::kExitInput, {"guess.csv", "r1"}, weights);
}

TEST_F(RigBadInput, OptionsOutOfRange) {
  const std::string command = "rig " + quoted(capture()) + " --template " + quoted(shapes()) + " --output " +
                              quoted(package()) + " --unit m --mask-radius 5cm ";
  const test::CommandResult iterations = runFacezip(command + "--iterations -1");
  EXPECT_EQ(iterations.exit_code, cli::kExitInput);
  EXPECT_THAT(iterations.error, HasSubstr("--iterations"));
  for (const char* value : {"0", "1e300"}) {
    const test::CommandResult damping = runFacezip(command + "--texture-damping " + value);
    EXPECT_EQ(damping.exit_code, cli::kExitInput) << value;
    EXPECT_THAT(damping.error, HasSubstr("--texture-damping: expected above 0 and at most 1e6, got "));
  }
  EXPECT_EQ(runFacezip(command + "--texture-solve magic").exit_code, cli::kExitUsage);
  EXPECT_FALSE(fs::exists(package()));
}

// What is unusual but not wrong is done, and said.
TEST_F(RigBadInput, ShapesThatMoveNothingPartsApartAndTrianglesWithoutAreaAreReported) {
  geometry::TriangleMesh still = geometry::readObj(shapes() / "neutral.obj");
  geometry::writeObj(shapes() / "nothing.obj", still);
  // A vertex on its neighbour leaves triangles without area.
  for (const fs::path& file :
       {capture() / "neutral.obj", capture() / "expressions/r0.obj", capture() / "expressions/r1.obj",
        capture() / "expressions/r2.obj", capture() / "expressions/r3.obj"}) {
    geometry::TriangleMesh mesh = geometry::readObj(file);
    mesh.positions.row(0) = mesh.positions.row(1);
    geometry::writeObj(file, mesh);
  }
  const test::CommandResult result = rig();
  EXPECT_EQ(result.exit_code, cli::kExitSuccess) << result.error;
  const std::string json = test::contentsOf(package() / "rig.json");
  EXPECT_THAT(json, HasSubstr("\"still_shapes\": [\n      \"nothing\""));
  EXPECT_THAT(json, testing::Not(HasSubstr("\"degenerate_triangles\": 0")));
}

TEST_F(RigBadInput, HeadsThatMoveAreNoticedAndHeldStill) {
  const auto expressions = [&] { return nlohmann::json::parse(test::contentsOf(folder_ / "r.json"))["expressions"]; };
  const std::string report = "--report " + quoted(folder_ / "r.json");
  EXPECT_THAT(rig(report).error, testing::Not(HasSubstr("--head-motion")));
  const nlohmann::json still = expressions();
  EXPECT_FALSE(still[0].contains("head_motion"));
  for (int n = 0; n < 4; ++n) {
    const fs::path file = capture() / "expressions" / ("r" + std::to_string(n) + ".obj");
    geometry::TriangleMesh mesh = geometry::readObj(file);
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.05 * (n + 1), Eigen::Vector3d::UnitX()).matrix();
    mesh.positions = (mesh.positions * turn.transpose()).rowwise() + Eigen::RowVector3d(0.02, -0.01 * n, 0.01);
    geometry::writeObj(file, mesh);
  }
  EXPECT_THAT(rig(report).error, HasSubstr("--head-motion takes that out"));
  const test::CommandResult held = rig("--head-motion " + report);
  const std::string solve = "solve-weights " + quoted(package()) + " " + quoted(capture() / "expressions") +
                            " --output " + quoted(folder_ / "clip.csv");
  EXPECT_THAT(runFacezip(solve).error, HasSubstr("--head-motion takes that out"));
  EXPECT_EQ(runFacezip(solve + " --head-motion").error, "");
  EXPECT_THAT(held.error, testing::Not(HasSubstr("--head-motion")));
  EXPECT_THAT(held.out, HasSubstr("head motion taken out: up to 11."));
  const nlohmann::json moved = expressions();
  for (std::size_t n = 0; n < 4; ++n) {
    EXPECT_NEAR(moved[n]["head_motion"]["degrees"].get<double>(), 0.05 * static_cast<double>(n + 1) * 57.3, 0.5);
    EXPECT_NEAR(moved[n]["residual_mm"]["mean"].get<double>(), still[n]["residual_mm"]["mean"].get<double>(), 0.02);
    for (const char* shape : test::kRigShapes) {
      EXPECT_NEAR(moved[n]["weights"].value(shape, 0.0), still[n]["weights"].value(shape, 0.0), 0.1) << n << shape;
    }
  }
}

TEST_F(RigBadInput, ExamplesThatRepeatStillWork) {
  for (const char* folder : {"expressions", "albedo"}) {
    const std::string ending = std::string(folder) == "albedo" ? ".png" : ".obj";
    fs::copy(capture() / folder / ("r1" + ending), capture() / folder / ("s1" + ending));
  }
  for (const char* solve : {"pseudo-inverse", "local"}) {
    const test::CommandResult result =
        rig(std::string("--texture-solve ") + solve + " --report " + quoted(folder_ / "r.json"));
    EXPECT_EQ(result.exit_code, cli::kExitSuccess) << result.error;
    EXPECT_THAT(test::contentsOf(folder_ / "r.json"), HasSubstr("\"rank\": 3"));
  }
}

TEST_F(RigBadInput, AShapeAndAnExpressionOfOneName) {
  fs::rename(shapes() / "bumpA.obj", shapes() / "r0.obj");
  EXPECT_EQ(rig().exit_code, cli::kExitSuccess);
  const test::CommandResult result = runFacezip("info " + quoted(package()));
  EXPECT_THAT(result.out, HasSubstr("r0_captured"));
}

TEST_F(RigBadInput, PartsBeyondTheSkinFollow) {
  for (const char* name : {"neutral", "bumpA", "bumpB", "bumpC"}) {
    const fs::path file = shapes() / (std::string(name) + ".obj");
    geometry::TriangleMesh mesh = geometry::readObj(file);
    const Eigen::Index first = mesh.positions.rows(), triangle = mesh.triangles.rows();
    mesh.positions.conservativeResize(first + 3, 3);
    mesh.positions.bottomRows(3) << 0.07, 0.07, 0.03, 0.08, 0.07, 0.03, 0.07, 0.08, 0.03;
    if (std::string(name) == "bumpA") mesh.positions.bottomRows(3).col(2).array() += 0.02;
    mesh.triangles.conservativeResize(triangle + 1, 3);
    mesh.uv_triangles.conservativeResize(triangle + 1, 3);
    const auto v = static_cast<int>(first);
    mesh.triangles.bottomRows(1) << v, v + 1, v + 2;
    mesh.uv_triangles.bottomRows(1) << 0, 1, 2;
    geometry::writeObj(file, mesh);
  }
  EXPECT_EQ(rig().exit_code, cli::kExitSuccess);
  const geometry::TriangleMesh neutral = geometry::readObj(package() / "shapes/neutral.obj");
  const geometry::TriangleMesh moved = geometry::readObj(package() / "shapes/bumpA.obj");
  ASSERT_EQ(neutral.positions.rows(), 21 * 21 + 3);
  EXPECT_GT(moved.positions(441, 2) - neutral.positions(441, 2), 0.01);
  // A tracked mesh of the captured skin alone is enough.
  EXPECT_EQ(runFacezip("solve-weights " + quoted(package()) + " " + quoted(capture() / "expressions/r0.obj") +
                       " --output " + quoted(folder_ / "clip.csv"))
                .exit_code,
            cli::kExitSuccess);
}

TEST_F(RigBadInput, SolvingWeightsSaysWhatIsWrong) {
  ASSERT_EQ(rig().exit_code, cli::kExitSuccess);
  const auto solve = [&](const fs::path& packed, const fs::path& mesh, const std::string& options = "") {
    return runFacezip("solve-weights " + quoted(packed) + " " + quoted(mesh) + " --output " +
                      quoted(folder_ / "clip.csv") + " " + options);
  };
  const fs::path good = capture() / "expressions/r0.obj";
  EXPECT_THAT(solve(capture(), good).error, HasSubstr("rig.json"));
  geometry::writeObj(folder_ / "other.obj", test::gridMesh(9));
  EXPECT_THAT(solve(package(), folder_ / "other.obj").error, HasSubstr("number of vertices"));
  EXPECT_EQ(solve(package(), folder_ / "none.obj").exit_code, cli::kExitInput);
  for (const char* value : {"-1", "1e300"}) {
    const test::CommandResult result = solve(package(), good, std::string("--smoothing ") + value);
    EXPECT_EQ(result.exit_code, cli::kExitInput) << value;
    EXPECT_THAT(result.error, HasSubstr("--smoothing: expected 0 to 1e6, got "));
  }
  io::writeTextFile(package() / "rig.json", "{\"format\": \"facezip-rig\", \"version\": 7}");
  EXPECT_THAT(solve(package(), good).error, HasSubstr("version"));
  EXPECT_FALSE(fs::exists(folder_ / "clip.csv"));
}

}  // namespace
}  // namespace facezip
