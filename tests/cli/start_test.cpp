// What a start costs: which libraries are loaded, and kernels that are compiled once.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>
#include <thread>

#include "file_contents.hpp"
#include "host/sample_package.hpp"
#include "run_command.hpp"
#include "small_capture.hpp"
#include "temporary_directory.hpp"

namespace facezip {
namespace {
namespace fs = std::filesystem;
using test::contentsOf;
using test::quoted;
using test::runFacezip;
using testing::HasSubstr;
using testing::Not;

class Start : public testing::Test {
 protected:
  void SetUp() override {
    test::SamplePackage sample = test::makeSample();
    test::writeSample(sample, folder_ / "package");
  }
  /// Blends a frame with kernels cached in `cache`; `before` stands before the command.
  test::CommandResult blend(const fs::path& cache, const fs::path& frame, const std::string& before = "") const {
    return runFacezip("blend " + quoted(folder_ / "package") + " --weights expression_1=0.5 --output " + quoted(frame),
                      "FACEZIP_CACHE_DIR=" + quoted(cache) + " " + before);
  }
  std::size_t filesIn(const std::string& name) const { return test::filesBelow(folder_ / name).size(); }
  const test::TemporaryDirectory folder_;
};

TEST_F(Start, OpenImageIoIsLoadedForOtherFilesThanPng) {
  const test::CommandResult png = blend(folder_ / "cache", folder_ / "frame.png", "LD_DEBUG=files");
  ASSERT_EQ(png.exit_code, 0);
  EXPECT_THAT(png.error, HasSubstr("libspng"));  // what counts libraries is in place
  EXPECT_THAT(png.error, Not(HasSubstr("libOpenImageIO")));
  EXPECT_THAT(png.error, Not(HasSubstr("libopencv")));  // `register` alone takes flow
  const test::CommandResult tif = blend(folder_ / "cache", folder_ / "frame.tif", "LD_DEBUG=files");
  ASSERT_EQ(tif.exit_code, 0);
  EXPECT_THAT(tif.error, HasSubstr("libOpenImageIO"));
}

TEST_F(Start, CapturesOfPngNeedNoOpenImageIo) {
  test::writeSmallCapture(folder_ / "capture", {.expressions = 5});
  // Nor do files that are no images need it to be told so.
  for (const char* folder : {"expressions", "notes", "albedo"}) {
    fs::create_directories(folder_ / "capture" / folder);
    for (const char* name : {"e00.obj", "read.me", "a.mtl", "noextension", "face.fbx"}) {
      fs::copy_file(folder_ / "capture/neutral.obj", folder_ / "capture" / folder / name);
    }
  }
  const test::CommandResult result =
      runFacezip("compress " + quoted(folder_ / "capture") + " --output " + quoted(folder_ / "compressed") +
                     " --unit m --mask-radius 5cm --restarts 3 --cluster-restarts 3",
                 "LD_DEBUG=files");
  ASSERT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.error, HasSubstr("libspng"));
  EXPECT_THAT(result.error, Not(HasSubstr("libOpenImageIO")));
}

TEST_F(Start, KernelsAreKept) {
  ASSERT_EQ(blend(folder_ / "cache", folder_ / "cold.png").exit_code, 0);
  const std::size_t kept = filesIn("cache");
  EXPECT_EQ(kept, 2u);  // blend.cl and weight_blend.cl
  ASSERT_EQ(blend(folder_ / "cache", folder_ / "warm.png").exit_code, 0);
  EXPECT_EQ(filesIn("cache"), kept);
  EXPECT_EQ(contentsOf(folder_ / "warm.png"), contentsOf(folder_ / "cold.png"));
}

TEST_F(Start, DamagedKernelsAreCompiledAgain) {
  ASSERT_EQ(blend(folder_ / "cache", folder_ / "cold.png").exit_code, 0);
  for (const auto& entry : fs::directory_iterator(folder_ / "cache")) {
    std::fstream file(entry.path(), std::ios::binary | std::ios::in | std::ios::out);
    file.seekp(-100, std::ios::end);
    file.write("damage", 6);
  }
  const test::CommandResult result = blend(folder_ / "cache", folder_ / "frame.png");
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.error, "");
  EXPECT_EQ(contentsOf(folder_ / "frame.png"), contentsOf(folder_ / "cold.png"));
}

TEST_F(Start, NothingIsKeptWhereNothingCanBeWritten) {
  for (const fs::path& cache : {fs::path("/proc/facezip"), fs::path()}) {
    const test::CommandResult result = blend(cache, folder_ / "frame.png");
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_EQ(result.error, "");
  }
}

TEST_F(Start, ProcessesMayStartAtOnce) {
  std::vector<test::CommandResult> results(3);
  std::vector<std::thread> threads;
  for (std::size_t t = 0; t < results.size(); ++t) {
    threads.emplace_back([&, t] { results[t] = blend(folder_ / "cache", folder_ / (std::to_string(t) + ".png")); });
  }
  for (std::thread& thread : threads) thread.join();
  for (std::size_t t = 0; t < results.size(); ++t) {
    EXPECT_EQ(results[t].exit_code, 0) << results[t].error;
    EXPECT_EQ(contentsOf(folder_ / (std::to_string(t) + ".png")), contentsOf(folder_ / "0.png"));
  }
  EXPECT_EQ(filesIn("cache"), 2u);  // no unfinished ones
}

TEST_F(Start, SaysThatItCompilesOnATerminalOnly) {
  const auto onTerminal = [this] {
    // "$0" "$@" are the command and its arguments, which `script` wants as one text.
    return blend(folder_ / "cache", folder_ / "frame.png",
                 "bash -c 'exec script --quiet --return --command \"$(printf \"%q \" \"$0\" \"$@\")\" /dev/null'");
  };
  const test::CommandResult cold = onTerminal();
  ASSERT_EQ(cold.exit_code, 0) << cold.out;
  EXPECT_THAT(cold.out, HasSubstr("compiling kernels"));
  EXPECT_THAT(onTerminal().out, Not(HasSubstr("compiling kernels")));
  EXPECT_EQ(blend(folder_ / "other", folder_ / "frame.png").error, "");
}

}  // namespace
}  // namespace facezip
