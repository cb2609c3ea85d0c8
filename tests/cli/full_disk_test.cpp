// A disk that is full: a small tmpfs, mounted in a namespace of its own.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "exit_codes.hpp"
#include "run_command.hpp"
#include "small_capture.hpp"
#include "temporary_directory.hpp"

namespace facezip {
namespace {
namespace fs = std::filesystem;
using test::quoted;

constexpr const char* kNamespace = "unshare --map-root-user --mount";

class FullDisk : public testing::Test {
 protected:
  void SetUp() override {
    const std::string probe = std::string(kNamespace) + " mount -t tmpfs none /mnt >/dev/null 2>&1";
    if (std::system(probe.c_str()) != 0) GTEST_SKIP() << "may not mount a tmpfs here";
    test::writeSmallCapture(folder_ / "capture", {.expressions = 3, .width = 256, .height = 256});
    fs::create_directory(folder_ / "disk");
  }

  /// Runs facezip where `disk` is a tmpfs of `size`; prints what is left on it behind "left:".
  test::CommandResult runOnDisk(const std::string& size, const std::string& arguments) const {
    const std::string script = "mount -t tmpfs -o size=" + size + " none " + quoted(folder_ / "disk") +
                               " && \"$0\" \"$@\"; code=$?; echo left: $(ls -A " + quoted(folder_ / "disk") +
                               "); exit $code";
    return test::runFacezip(arguments, std::string(kNamespace) + " sh -c \"" + escaped(script) + "\"");
  }

  static std::string escaped(const std::string& script) {
    std::string text;
    for (const char c : script) {
      if (c == '"' || c == '$' || c == '\\') text += '\\';
      text += c;
    }
    return text;
  }

  const test::TemporaryDirectory folder_;
};

TEST_F(FullDisk, CompressFailsClearlyAndLeavesNothing) {
  const test::CommandResult result =
      runOnDisk("64k", "compress " + quoted(folder_ / "capture") + " --output " + quoted(folder_ / "disk/package") +
                           " --unit m --mask-radius 5cm --restarts 3 --cluster-restarts 3");
  EXPECT_EQ(result.exit_code, cli::kExitOutput) << result.error;
  EXPECT_THAT(result.error, testing::HasSubstr("cannot write"));
  EXPECT_THAT(result.out, testing::HasSubstr("left:\n"));
}

TEST_F(FullDisk, SynthFailsClearlyAndLeavesNothing) {
  const test::CommandResult result =
      runOnDisk("128k", "synth --resolution 128 --expressions 3 --output " + quoted(folder_ / "disk/capture"));
  EXPECT_EQ(result.exit_code, cli::kExitOutput) << result.error;
  EXPECT_THAT(result.out, testing::HasSubstr("left:\n"));
}

TEST_F(FullDisk, EnoughRoomForThePackageAloneIsEnough) {
  const test::CommandResult result =
      runOnDisk("1500k", "compress " + quoted(folder_ / "capture") + " --output " + quoted(folder_ / "disk/package") +
                             " --unit m --mask-radius 5cm --restarts 3 --cluster-restarts 3");
  EXPECT_EQ(result.exit_code, cli::kExitSuccess) << result.error;
  EXPECT_THAT(result.error, testing::HasSubstr("decoding them in every pass"));
  EXPECT_THAT(result.out, testing::HasSubstr("left: package\n"));
}

}  // namespace
}  // namespace facezip
