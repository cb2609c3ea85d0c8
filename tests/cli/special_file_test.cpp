// Pipes, devices, folders and links that lead nowhere in the place of every file that a command reads: an error that
// names the file, at once, and nothing left behind.
#include "special_file.hpp"

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
using testing::HasSubstr;

class SpecialFiles : public testing::Test {
 protected:
  void SetUp() override {
    test::writeRigCapture(folder_.path());
    const image::Image white =
        test::makeImage({16, 16, 1, image::SampleType::kUint8}, [](int, int, int) { return 255.0; });
    for (const char* name : {"coverage.png", "importance.png"}) image::writeImage(capture() / name, white);
    io::writeTextFile(capture() / "capture.json", "{}");
  }

  fs::path capture() const { return folder_ / "capture"; }
  std::string compress() const {
    return "compress " + quoted(capture()) + " --output " + quoted(folder_ / "out") + " --unit m --mask-radius 5cm";
  }
  std::string rig(const std::string& options = "") const {
    return "rig " + quoted(capture()) + " --template " + quoted(folder_ / "template") + " --output " +
           quoted(folder_ / "rig") + " --unit m --mask-radius 5cm --iterations 1" + options;
  }

  /// `arguments` fail for each kind of special file in the place of `file`, which need not be there.
  /// folders  are no fault there
  void expectRefusal(const fs::path& file, const std::string& arguments, bool folders = false) const {
    const fs::path aside = folder_ / "aside";
    const bool there = fs::exists(file);
    if (there) fs::rename(file, aside);
    for (const test::SpecialFile& special : test::specialFiles()) {
      if (folders && special.name == "a folder") continue;
      special.put(file);
      const auto before = test::filesBelow(folder_.path());
      const test::CommandResult result = runFacezip(arguments, "timeout 20");
      EXPECT_EQ(result.exit_code, cli::kExitInput) << file << ", " << special.name << ": " << result.error;
      EXPECT_THAT(result.error, HasSubstr(file.filename().string()));
      // A special file may be put there by a link, which packages refuse whatever is behind it.
      EXPECT_THAT(result.error, testing::AnyOf(HasSubstr(special.name), HasSubstr("a link"))) << file;
      EXPECT_EQ(result.out, "");
      EXPECT_EQ(test::filesBelow(folder_.path()), before) << file;
      fs::remove_all(file);
      fs::remove(file.string() + ".pipe");
    }
    if (there) fs::rename(aside, file);
  }

  const test::TemporaryDirectory folder_;
};

TEST_F(SpecialFiles, OfACaptureAreRefused) {
  for (const char* file : {"capture.json", "neutral.obj", "expressions/r1.obj", "albedo/neutral.png", "albedo/r1.png",
                           "albedo/new.png", "albedo/new.TIF", "face_region.txt", "coverage.png", "importance.png"}) {
    expectRefusal(capture() / file, compress());
  }
  fs::remove(capture() / "neutral.obj");
  expectRefusal(capture() / "neutral.OBJ", compress());
}

TEST_F(SpecialFiles, OfOptionsAreRefused) {
  for (const char* option : {"--region ", "--importance "}) {
    for (const char* name : {"given.png", "given.exr", "given.txt"}) {
      expectRefusal(folder_ / name, compress() + " " + option + quoted(folder_ / name));
    }
  }
}

TEST_F(SpecialFiles, OfATemplateAndAGuessAreRefused) {
  for (const char* file : {"neutral.obj", "bumpB.obj", "new.obj"}) expectRefusal(folder_ / "template" / file, rig());
  for (const char* name : {"guess.csv", "guess.json"}) {
    expectRefusal(folder_ / name, rig(" --weights " + quoted(folder_ / name)));
  }
}

TEST_F(SpecialFiles, OfPackagesClipsGainsAndTrackedMeshesAreRefused) {
  ASSERT_EQ(runFacezip(rig()).exit_code, cli::kExitSuccess);
  const std::string package = quoted(folder_ / "rig");
  const std::string frame = " --output " + quoted(folder_ / "frame%d.png");
  expectRefusal(folder_ / "clip.csv", "blend " + package + frame + " --animation " + quoted(folder_ / "clip.csv"));
  expectRefusal(folder_ / "gain.json",
                "blend " + package + frame + " --weights '' --gain " + quoted(folder_ / "gain.json"));
  const std::string solve = "solve-weights " + package + " --output " + quoted(folder_ / "solved.csv") + " ";
  expectRefusal(folder_ / "frame.obj", solve + quoted(folder_ / "frame.obj"), /*folders=*/true);
  fs::create_directory(folder_ / "frames");
  expectRefusal(folder_ / "frames/0001.obj", solve + quoted(folder_ / "frames"));
  const std::string blend = "blend " + package + frame + " --weights ''";
  for (const char* file : {"package.json", "weights.png", "albedo/neutral.png", "albedo/difference_0.png"}) {
    expectRefusal(folder_ / "rig" / file, blend);
  }
  for (const char* file : {"rig.json", "shapes/neutral.obj", "shapes/bumpA.obj"}) {
    expectRefusal(folder_ / "rig" / file, solve + quoted(capture() / "expressions"));
  }
  expectRefusal(folder_ / "report.json", "report " + quoted(capture()) + " " + package + " --output " +
                                             quoted(folder_ / "page.html") + " --compress-report " +
                                             quoted(folder_ / "report.json"));
  expectRefusal(folder_ / "report.json", "report " + quoted(capture()) + " " + package + " --output " +
                                             quoted(folder_ / "page.html") + " --registration-report " +
                                             quoted(folder_ / "report.json"));
}

}  // namespace
}  // namespace facezip
