// Commands that are killed again and again, at any moment: what they replace is the old one or the new one, whole, and
// the run after them removes what they left. FACEZIP_KILLS says how many times (100).
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <functional>
#include <random>
#include <thread>
#include <vector>

#include "file_contents.hpp"
#include "io/staged_directory.hpp"
#include "run_command.hpp"
#include "small_capture.hpp"
#include "temporary_directory.hpp"

namespace facezip {
namespace {
namespace fs = std::filesystem;
using test::quoted;
using test::runFacezip;
using Clock = std::chrono::steady_clock;

/// Runs facezip and kills it after `delay`, if it is still at work. True if it was.
bool runAndKill(const std::vector<std::string>& arguments, std::chrono::microseconds delay) {
  std::vector<char*> argv = {const_cast<char*>("facezip"), const_cast<char*>("--quiet")};
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  const pid_t child = ::fork();
  if (child == 0) {
    if (::freopen("/dev/null", "w", stdout) != nullptr) ::execv(FACEZIP_COMMAND, argv.data());
    ::_exit(127);
  }
  const Clock::time_point end = Clock::now() + delay;
  int status = 0;
  bool ended = false;
  while (!ended && Clock::now() < end) {
    ended = ::waitpid(child, &status, WNOHANG) == child;
    if (!ended) std::this_thread::sleep_for(std::chrono::microseconds(100));
  }
  if (!ended) {
    ::kill(child, SIGKILL);
    ::waitpid(child, &status, 0);
  }
  EXPECT_TRUE(WIFSIGNALED(status) || WEXITSTATUS(status) == 0) << status;
  return WIFSIGNALED(status);
}

/// A command, and whether what it writes is whole.
struct Victim {
  std::vector<std::string> arguments;
  std::function<void()> check;
};

class Kill : public testing::Test {
 protected:
  void SetUp() override {
    for (const char* capture : {"a", "b"}) {
      test::writeSmallCapture(folder_ / capture, {.expressions = capture[0] == 'a' ? 3 : 4, .width = 64, .height = 64});
    }
    io::writeTextFile(folder_ / "clip.csv", "frame,e00\n0,1\n1,0.5\n2,0\n");
    ASSERT_EQ(
        runFacezip("compress " + quoted(folder_ / "a") + " -o " + quoted(folder_ / "source") + kOptions).exit_code, 0);
  }

  std::string at(const fs::path& name) const { return (folder_ / name).string(); }

  std::vector<std::string> compress(const char* capture) const {
    return {"compress", at(capture),     "-o",  at("out/face"), "--report", at("out/report.json"), "--unit",
            "m",        "--mask-radius", "5cm", "--restarts",   "3"};
  }

  std::vector<Victim> victims() const {
    const auto package_is_whole = [this] {
      const test::CommandResult info = runFacezip("info " + quoted(folder_ / "out/face"));
      EXPECT_EQ(info.exit_code, 0) << info.error;
      const std::string report = test::contentsOf(folder_ / "out/report.json");
      EXPECT_TRUE(report.ends_with("}\n")) << report;
    };
    const auto frames_are_whole = [this] {
      for (const char* frame : {"out/0.png", "out/1.png", "out/2.png"}) {
        const image::Image image = image::readImage(folder_ / frame);
        EXPECT_EQ(image.shape.width, 64);
      }
    };
    const auto export_is_whole = [this] {
      EXPECT_EQ(runFacezip("info " + quoted(folder_ / "out/exported/package")).exit_code, 0);
    };
    return {{compress("a"), package_is_whole},
            {compress("b"), package_is_whole},
            {{"blend", at("source"), "--animation", at("clip.csv"), "-o", at("out/%d.png")}, frames_are_whole},
            {{"export", at("source"), "--target", "gltf", "-o", at("out/exported")}, export_is_whole}};
  }

  static constexpr const char* kOptions = " --unit m --mask-radius 5cm --restarts 3";
  const test::TemporaryDirectory folder_;
};

TEST_F(Kill, LeavesTheOldOrTheNew) {
  const char* wanted = std::getenv("FACEZIP_KILLS");
  const int kills = wanted == nullptr ? 100 : std::atoi(wanted);
  const std::vector<Victim> all = victims();
  std::vector<Clock::duration> durations;
  for (const Victim& victim : all) {  // all that is killed replaces something; and how long it takes
    const Clock::time_point start = Clock::now();
    ASSERT_FALSE(runAndKill(victim.arguments, std::chrono::seconds(30)));
    durations.push_back(Clock::now() - start);
    victim.check();
  }
  std::mt19937 random(7);
  for (int k = 0, killed = 0; killed < kills; ++k) {
    const std::size_t v = static_cast<std::size_t>(k) % all.size();
    const auto whole = std::chrono::duration_cast<std::chrono::microseconds>(durations[v]);
    // The end, where files are put in place, more often than the work before it.
    const double share = std::max(std::uniform_real_distribution<>(0.0, 1.1)(random),
                                  std::uniform_real_distribution<>(0.0, 1.1)(random));
    const Clock::time_point start = Clock::now();
    if (runAndKill(all[v].arguments, std::chrono::microseconds(static_cast<long>(share * whole.count())))) {
      ++killed;
    } else {  // the machine was busier when the duration was measured
      durations[v] = std::min(durations[v], Clock::duration(Clock::now() - start));
    }
    all[v].check();
    if (HasFailure()) FAIL() << "kill " << k;
  }
  for (const Victim& victim : all) ASSERT_FALSE(runAndKill(victim.arguments, std::chrono::seconds(30)));
  for (const std::string& name : test::filesBelow(folder_ / "out")) {
    EXPECT_EQ(name.find(".partial"), std::string::npos) << name << " is left";
  }
}

}  // namespace
}  // namespace facezip
