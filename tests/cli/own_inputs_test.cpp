// No output of any command is one of its inputs, lies in one or, where it replaces a folder, holds one; nor are two
// outputs one file.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "exit_codes.hpp"
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

class OwnInputs : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new test::TemporaryDirectory;
    test::writeRigCapture(folder_->path());
    io::writeTextFile(at("guess.json"),
                      R"({"r0": {"bumpA": 1}, "r1": {"bumpB": 1}, "r2": {"bumpA": 1}, "r3": {"bumpC": 1}})");
    ASSERT_EQ(runFacezip(rig() + " -o " + quoted(at("face"))).exit_code, cli::kExitSuccess);
    io::writeTextFile(at("clip.csv"), "frame,r0\n0,1\n1,0\n");
    io::writeTextFile(at("gain.json"), R"({"format": "facezip-gains", "version": 1, "package": "capture"})");
    fs::create_hard_link(at("capture/albedo/r0.png"), at("hard.png"));
    fs::create_hard_link(at("capture/neutral.obj"), at("hard.html"));
    fs::create_directory_symlink("capture", at("link"));
    fs::create_directory_symlink("face", at("face-link"));
  }
  static void TearDownTestSuite() { delete folder_; }

  static fs::path at(const fs::path& name) { return *folder_ / name; }
  static std::string q(const fs::path& name) { return quoted(at(name)); }
  static std::string compress() { return "compress " + q("capture") + " --unit m --mask-radius 5cm --restarts 2"; }
  static std::string rig() {
    return "rig " + q("capture") + " --template " + q("template") + " --unit m --mask-radius 5cm --iterations 1";
  }

  static void expectRefusal(const std::string& arguments) {
    const auto names = test::filesBelow(folder_->path());
    const auto files = test::filesOf(folder_->path());
    const test::CommandResult result = runFacezip(arguments);
    EXPECT_EQ(result.exit_code, cli::kExitOutput) << arguments << ": " << result.error;
    EXPECT_THAT(result.error, testing::HasSubstr("cannot write: ")) << arguments;
    EXPECT_THAT(result.error, testing::HasSubstr("choose another --")) << arguments;
    EXPECT_EQ(test::filesBelow(folder_->path()), names) << arguments;
    EXPECT_EQ(test::filesOf(folder_->path()), files) << arguments;
  }

  static const test::TemporaryDirectory* folder_;
};
const test::TemporaryDirectory* OwnInputs::folder_ = nullptr;

TEST_F(OwnInputs, Compress) {
  for (const char* output : {"capture", "capture/package", "link/package", "capture/albedo/deep/package", "."}) {
    expectRefusal(compress() + " -o " + q(output));
  }
  const std::string whole = compress() + " -o " + q("package") + " --report ";
  for (const char* report :
       {"capture/neutral.obj", "capture/r.json", "link/albedo/r0.png", "hard.png", "package", "package/r.json"}) {
    expectRefusal(whole + q(report));
  }
  expectRefusal(compress() + " -o " + q("package") + " --importance " + q("hard.png") + " --report " + q("hard.png"));
  // A painted image from the package that is to be replaced.
  expectRefusal(compress() + " -o " + q("face") + " --importance " + q("face/masks.png"));
}

TEST_F(OwnInputs, Convert) {
  const std::string convert = "convert " + q("face") + " --texture-format bc7 -o ";
  for (const char* output : {"face", "face-link", "face/albedo", "face/blocks", "."})
    expectRefusal(convert + q(output));
  for (const char* report : {"face/package.json", "face/r.json", "package", "package/r.json"}) {
    expectRefusal(convert + q("package") + " --report " + q(report));
  }
}

TEST_F(OwnInputs, Align) {
  for (const char* output : {"capture", "capture/aligned", "link/aligned", "."}) {
    expectRefusal("align " + q("capture") + " -o " + q(output));
  }
  for (const char* report : {"capture/neutral.obj", "capture/r.json", "hard.png", "aligned", "aligned/r.json"}) {
    expectRefusal("align " + q("capture") + " -o " + q("aligned") + " --report " + q(report));
  }
  expectRefusal("align " + q("capture") + " -o " + q("aligned") + " --region " + q("hard.png") + " --report " +
                q("hard.png"));
}

TEST_F(OwnInputs, Rig) {
  expectRefusal(rig() + " -o " + q("template/package"));
  expectRefusal(rig() + " -o " + q("capture/package"));
  const std::string guessed = rig() + " --weights " + q("guess.json") + " -o " + q("package") + " --report ";
  for (const char* report : {"guess.json", "template/bumpA.obj", "capture/capture.json", "package/r.json"}) {
    expectRefusal(guessed + q(report));
  }
  // The shapes of a rig as the template of the rig that replaces it.
  expectRefusal("rig " + q("capture") + " --template " + q("face/shapes") + " --unit m -o " + q("face"));
}

TEST_F(OwnInputs, Evaluate) {
  const std::string evaluate = "evaluate " + q("capture") + " " + q("face") + " --baselines none ";
  for (const char* report : {"capture/neutral.obj", "face/package.json", "face/new.json", "face-link/new.json"}) {
    expectRefusal(evaluate + "--report " + q(report));
  }
  for (const char* picture : {"capture/albedo/r0.png", "capture/new.png", "face/albedo/neutral.png", "hard.png"}) {
    expectRefusal(evaluate + "--picture " + q(picture));
  }
  expectRefusal(evaluate + "--report " + q("one.png") + " --picture " + q("one.png"));
}

TEST_F(OwnInputs, Report) {
  io::writeTextFile(at("compress.html"), R"({"facezip_report": "compress"})");
  io::writeTextFile(at("register.html"), R"({"facezip_report": "register", "scans": [{"name": "neutral"}]})");
  const std::string report = "report " + q("capture") + " " + q("face") + " -o ";
  for (const char* page : {"capture/page.html", "face/page.html", "hard.html"}) expectRefusal(report + q(page));
  expectRefusal(report + q("compress.html") + " --compress-report " + q("compress.html"));
  expectRefusal(report + q("register.html") + " --registration-report " + q("register.html"));
}

TEST_F(OwnInputs, BlendAndReconstruct) {
  const std::string blend = "blend " + q("face");
  for (const char* frame : {"face/x.png", "face/albedo/neutral.png", "face-link/x.png"}) {
    expectRefusal(blend + " --weights r0=1 -o " + q(frame));
  }
  // No input, but a frame there would be one more expression of the capture.
  expectRefusal(blend + " --weights r0=1 -o " + q("capture/albedo/x.png"));
  expectRefusal(blend + " --weights r0=1 -o " + q("link/albedo/r0.png"));
  expectRefusal(blend + " --weights r0=1 --gain " + q("gain.json") + " -o " + q("face/x.png"));
  expectRefusal(blend + " --animation " + q("clip.csv") + " -o " + q("face/%d.png"));
  // A frame of the clip that only its number makes an input.
  fs::copy_file(at("clip.csv"), at("1.png"));
  expectRefusal(blend + " --animation " + q("1.png") + " -o " + q("%d.png"));
  fs::remove(at("1.png"));
  expectRefusal("reconstruct " + q("face") + " -o " + q("face/decoded"));
  // The folder of a map is a link into the package.
  fs::create_directory(at("decoded"));
  fs::create_directory_symlink("../face/shapes", at("decoded/albedo"));
  expectRefusal("reconstruct " + q("face") + " -o " + q("decoded"));
  fs::remove_all(at("decoded"));
}

TEST_F(OwnInputs, ExportAndView) {
  for (const char* output : {"face/out", "face", "."}) {
    expectRefusal("export " + q("face") + " --target gltf -o " + q(output));
    expectRefusal("view " + q("face") + " -o " + q(output));
  }
  // An export of a package out of the export that it replaces.
  ASSERT_EQ(runFacezip("export " + q("face") + " --target gltf -o " + q("exported")).exit_code, cli::kExitSuccess);
  expectRefusal("export " + q("exported/package") + " --target gltf -o " + q("exported"));
}

TEST_F(OwnInputs, SolveWeights) {
  const std::string solve = "solve-weights " + q("face") + " " + q("capture/expressions") + " -o ";
  for (const char* clip : {"capture/expressions/r0.obj", "capture/expressions/clip.csv", "face/clip.csv"}) {
    expectRefusal(solve + q(clip));
    expectRefusal(solve + q("solved.csv") + " --report " + q(clip));
  }
  expectRefusal(solve + q("solved.csv") + " --report " + q("solved.csv"));
  expectRefusal("solve-weights " + q("face") + " " + q("capture/expressions/r0.obj") + " -o " +
                q("link/expressions/r0.obj"));
}

TEST_F(OwnInputs, WhatLiesBesideThemIsWritten) {
  EXPECT_EQ(runFacezip("solve-weights " + q("face") + " " + q("capture/expressions/r0.obj") + " -o " + q("s.csv") +
                       " --report " + q("s.json"))
                .exit_code,
            cli::kExitSuccess);
  EXPECT_EQ(runFacezip("blend " + q("face") + " --weights r0=1 -o " + q("capture2.png")).exit_code, cli::kExitSuccess);
  const test::CommandResult piped = runFacezip(compress() + " -o " + q("package") + " --report /dev/stdout");
  EXPECT_EQ(piped.exit_code, cli::kExitSuccess) << piped.error;
  EXPECT_THAT(piped.out, testing::HasSubstr("facezip_report"));
}

}  // namespace
}  // namespace facezip
