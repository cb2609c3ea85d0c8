// What is published was on the disk before: each file, and each folder that names it, is synced before the rename, and
// the folder it is renamed in after.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

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

class Durability : public testing::Test {
 protected:
  void SetUp() override {
    if (FACEZIP_SANITIZED) GTEST_SKIP() << "the sanitizer must be the first library";
    test::writeRigCapture(folder_.path());
  }

  /// Runs a command and returns what it synced and renamed below the folder, in order.
  std::vector<std::string> run(const std::string& arguments) const {
    const fs::path log = folder_ / "log";
    fs::remove(log);
    const test::CommandResult result =
        test::runFacezip(arguments, "LD_PRELOAD=" + quoted(FACEZIP_LOG_SYNCS) + " FACEZIP_SYNC_LOG=" + quoted(log));
    EXPECT_EQ(result.exit_code, cli::kExitSuccess) << arguments << ": " << result.error;
    std::vector<std::string> lines;
    std::ifstream stream(log);
    for (std::string line; std::getline(stream, line);) {
      if (line.find(folder_.path().string()) != std::string::npos) lines.push_back(line);
    }
    return lines;
  }

  static std::size_t indexOf(const std::vector<std::string>& lines, const std::string& line) {
    return static_cast<std::size_t>(std::find(lines.begin(), lines.end(), line) - lines.begin());
  }

  /// The last rename puts `output` in place; all that it consists of was synced before, its folder is after.
  void expectDurable(const std::vector<std::string>& lines, const fs::path& output) const {
    const std::string end = " " + output.string();
    const auto renamed = std::find_if(lines.rbegin(), lines.rend(), [&](const std::string& line) {
      return line.starts_with("rename ") && line.ends_with(end);
    });
    ASSERT_NE(renamed, lines.rend()) << output;
    const std::size_t at = static_cast<std::size_t>(lines.rend() - renamed) - 1;
    const std::string from = renamed->substr(7, renamed->size() - 7 - end.size());
    std::vector<fs::path> parts = {from};
    if (fs::is_directory(output)) {
      for (const std::string& name : test::filesBelow(output)) parts.push_back(from / fs::path(name));
    }
    for (const fs::path& part : parts) EXPECT_LT(indexOf(lines, "sync " + part.string()), at) << part;
    const auto after = std::find(lines.begin() + static_cast<std::ptrdiff_t>(at), lines.end(),
                                 "sync " + output.parent_path().string());
    EXPECT_NE(after, lines.end()) << output;
  }

  const test::TemporaryDirectory folder_;
};

TEST_F(Durability, OfEveryOutput) {
  const fs::path package = folder_ / "face";
  const std::string rig = "rig " + quoted(folder_ / "capture") + " --template " + quoted(folder_ / "template") +
                          " --unit m --mask-radius 5cm --iterations 1 -o " + quoted(package) + " --report " +
                          quoted(folder_ / "report.json");
  for (int time = 0; time < 2; ++time) {  // where nothing stands, and over an earlier one
    const std::vector<std::string> lines = run(rig);
    expectDurable(lines, package);
    expectDurable(lines, folder_ / "report.json");
  }
  const fs::path clip = folder_ / "clip.csv";
  expectDurable(
      run("solve-weights " + quoted(package) + " " + quoted(folder_ / "capture/expressions") + " -o " + quoted(clip)),
      clip);
  const std::vector<std::string> frames =
      run("blend " + quoted(package) + " --animation " + quoted(clip) + " -o " + quoted(folder_ / "frames/%d.png"));
  for (const char* name : {"0.png", "1.png", "2.png", "3.png"}) expectDurable(frames, folder_ / "frames" / name);
  expectDurable(run("export " + quoted(package) + " --target gltf -o " + quoted(folder_ / "exported")),
                folder_ / "exported");
  // Files that are added to a folder.
  const std::vector<std::string> decoded =
      run("reconstruct " + quoted(package) + " --expression r1 -o " + quoted(folder_ / "decoded"));
  expectDurable(decoded, folder_ / "decoded/albedo/r1.png");
}

}  // namespace
}  // namespace facezip
