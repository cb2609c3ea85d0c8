// Bad libraries, models and neutrals for `train` and `generate`: one clear error, the right exit code, nothing left
// behind.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "exit_codes.hpp"
#include "file_contents.hpp"
#include "learn_library.hpp"
#include "run_command.hpp"
#include "temporary_directory.hpp"

namespace facezip {
namespace {
namespace fs = std::filesystem;
using test::quoted;
using test::runFacezip;
using testing::HasSubstr;

/// A library of four, a model of it, and a stranger; made once, every test has a copy.
class LearnBadInput : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    made_ = new test::TemporaryDirectory;
    test::writeLearnLibrary(made_->path(), 4);
    const test::CommandResult trained =
        runFacezip(trainLine(made_->path()) + " --report " + quoted(made_->path() / "train.json"));
    ASSERT_EQ(trained.exit_code, cli::kExitSuccess) << trained.error;
  }
  static void TearDownTestSuite() { delete made_; }
  void SetUp() override {
    fs::copy(made_->path(), folder_.path(), fs::copy_options::recursive | fs::copy_options::overwrite_existing);
  }

  static std::string trainLine(const fs::path& folder) {
    return "train " + quoted(folder / "library") + " --template " + quoted(folder / "library/template") + " --facs " +
           quoted(folder / "library/facs.json") + " --output " + quoted(folder / "model") + " --resolution 64 ";
  }
  std::string generateLine() const {
    return "generate " + quoted(folder_ / "stranger") + " --model " + quoted(folder_ / "model") + " --output " +
           quoted(folder_ / "face") + " --mask-radius 5cm --restarts 2 ";
  }

  void expectFailure(const std::string& line, int exit_code, const std::vector<std::string>& parts) const {
    const auto files = test::filesBelow(folder_.path());
    const std::string model = test::contentsOf(folder_ / "model");
    const test::CommandResult result = runFacezip(line);
    EXPECT_EQ(result.exit_code, exit_code) << result.error;
    for (const std::string& part : parts) EXPECT_THAT(result.error, HasSubstr(part));
    EXPECT_THAT(result.error, HasSubstr("facezip: error: "));
    EXPECT_EQ(result.out, "");
    EXPECT_EQ(test::filesBelow(folder_.path()), files) << "something was left behind";
    EXPECT_EQ(test::contentsOf(folder_ / "model"), model) << "the model of before is gone";
  }
  void trainFails(const std::vector<std::string>& parts, const std::string& options = "") const {
    expectFailure(trainLine(folder_.path()) + options, cli::kExitInput, parts);
  }
  void generateFails(const std::vector<std::string>& parts, const std::string& options = "") const {
    expectFailure(generateLine() + options, cli::kExitInput, parts);
  }

  fs::path subject(int s) const { return folder_ / "library/subjects" / std::to_string(s); }

  static test::TemporaryDirectory* made_;
  const test::TemporaryDirectory folder_;
};

test::TemporaryDirectory* LearnBadInput::made_ = nullptr;

TEST_F(LearnBadInput, GoodInputIsTakenAndTold) {
  const test::CommandResult generated = runFacezip(generateLine() + "--report " + quoted(folder_ / "generate.json"));
  EXPECT_EQ(generated.exit_code, cli::kExitSuccess) << generated.error;
  EXPECT_THAT(generated.out, HasSubstr("albedo"));
  EXPECT_TRUE(fs::exists(folder_ / "face/package.json"));
  EXPECT_TRUE(fs::exists(folder_ / "generate.json"));
}

TEST_F(LearnBadInput, WithoutAModelItIsSaidWhatToDo) {
  expectFailure("generate " + quoted(folder_ / "stranger") + " --output " + quoted(folder_ / "face"), cli::kExitInput,
                {"--model", "facezip train", "docs/learning.md", "facezip rig"});
}

TEST_F(LearnBadInput, LibrariesThatSayTooLittle) {
  for (int s = 1; s < 4; ++s) fs::remove_all(subject(s));
  trainFails({"library", "at least two people"});
  fs::remove_all(folder_ / "library/subjects");
  trainFails({"library"});
}

TEST_F(LearnBadInput, ASubjectWithoutAnExpression) {
  fs::remove(subject(2) / "expressions/upper.obj");
  fs::remove(subject(2) / "albedo/upper.png");
  trainFails({"subjects/2", "\"upper\"", "complete the subject"});
}

TEST_F(LearnBadInput, ASubjectWithAnExpressionsTextureAlone) {
  fs::remove(subject(1) / "expressions/left.obj");
  trainFails({"subjects/1", "left"});
}

TEST_F(LearnBadInput, ASubjectOfAnotherTopology) {
  geometry::writeObj(subject(3) / "neutral.obj", test::gridMesh(9));
  trainFails({"subjects/3/neutral.obj", "441", "81"});
}

TEST_F(LearnBadInput, MeshesThatAreNone) {
  io::writeTextFile(subject(1) / "expressions/all.obj", "v 0 0 nan\nf 1 1 1\n");
  trainFails({"subjects/1/expressions/all.obj", "line 1"});
  io::writeTextFile(subject(1) / "expressions/all.obj", "");
  trainFails({"subjects/1/expressions/all.obj", "no vertices"});
}

TEST_F(LearnBadInput, TexturesThatAreNone) {
  io::writeTextFile(subject(1) / "albedo/all.png", "no image");
  trainFails({"subjects/1/albedo/all.png"});
}

TEST_F(LearnBadInput, AskedWeightsThatDoNotFit) {
  const fs::path facs = folder_ / "library/facs.json";
  io::writeTextFile(facs, R"({"left": {"bumpA": 1}})");
  trainFails({"facs.json", "its weights"});
  io::writeTextFile(facs, R"({"left": {"bumpQ": 1}, "right": {}, "upper": {}, "all": {}})");
  trainFails({"facs.json", "bumpQ"});
  io::writeTextFile(facs, R"({"left": {"bumpA": 3}, "right": {}, "upper": {}, "all": {}})");
  trainFails({"facs.json", "3"});
  io::writeTextFile(facs, "{");
  trainFails({"facs.json"});
  fs::remove(facs);
  trainFails({"facs.json"});
}

TEST_F(LearnBadInput, ATemplateOfAnotherTopology) {
  for (const char* name : {"neutral", "bumpA", "bumpB", "bumpC"}) {
    geometry::writeObj(folder_ / "library/template" / (std::string(name) + ".obj"), test::gridMesh(9));
  }
  trainFails({"template/neutral.obj", "441", "81"});
}

TEST_F(LearnBadInput, OptionsOutOfRange) {
  const std::string line = trainLine(folder_.path());
  expectFailure(line.substr(0, line.find("--resolution")) + "--resolution 8", cli::kExitInput, {"resolution"});
  trainFails({"rounds"}, "--rounds 0");
  trainFails({"gloss"}, "--maps gloss");
  generateFails({"--eyes", "hazel"}, "--eyes pink");
}

TEST_F(LearnBadInput, ModelsThatAreNone) {
  const std::string whole = test::contentsOf(folder_ / "model");
  io::writeTextFile(folder_ / "model", "");
  generateFails({"model", "`facezip train` wrote"});
  io::writeTextFile(folder_ / "model", "PK\x03\x04 somebody's pickle");
  generateFails({"model", "`facezip train` wrote"});
  io::writeTextFile(folder_ / "model", whole.substr(0, whole.size() / 2));
  generateFails({"model"});
  std::string other = whole;
  other[8] = 9;
  io::writeTextFile(folder_ / "model", other);
  generateFails({"model", "version"});
}

TEST_F(LearnBadInput, ANeutralThatTheModelDoesNotFit) {
  geometry::writeObj(folder_ / "stranger/neutral.obj", test::gridMesh(9));
  generateFails({"neutral.obj", "441", "81", "facezip register"});
  // The same topology, laid out otherwise.
  geometry::TriangleMesh turned = test::learnNeutral(1.1);
  turned.uvs.col(0).swap(turned.uvs.col(1));
  geometry::writeObj(folder_ / "stranger/neutral.obj", turned);
  generateFails({"neutral.obj"});
  fs::remove(folder_ / "stranger/neutral.obj");
  generateFails({"stranger"});
}

TEST_F(LearnBadInput, OutputsThatAreInputs) {
  expectFailure("generate " + quoted(folder_ / "stranger") + " --model " + quoted(folder_ / "model") + " --output " +
                    quoted(folder_ / "stranger"),
                cli::kExitOutput, {"stranger"});
  expectFailure("train " + quoted(folder_ / "library") + " --template " + quoted(folder_ / "library/template") +
                    " --facs " + quoted(folder_ / "library/facs.json") + " --output " +
                    quoted(folder_ / "library/facs.json"),
                cli::kExitOutput, {"facs.json"});
}

}  // namespace
}  // namespace facezip
