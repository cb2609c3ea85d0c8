// Names of strangers on the terminal, names as long as the file system takes, and places that are not there: HOME, the
// cache of kernels, the directory for temporary files.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "exit_codes.hpp"
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
using testing::HasSubstr;
using testing::Not;

class Names : public testing::Test {
 protected:
  void SetUp() override {
    test::writeSmallCapture(folder_ / "capture", {.expressions = 3, .width = 48, .height = 48});
    const test::CommandResult made = runFacezip(compress("package"));
    ASSERT_EQ(made.exit_code, 0) << made.error;
  }

  std::string compress(const fs::path& output) const {
    return "compress " + quoted(folder_ / "capture") + " -o " + quoted(folder_ / output) +
           " --unit m --mask-radius 5cm --restarts 3";
  }

  /// Nothing that a terminal would obey, nor that hides; the error is one line.
  static void expectHarmless(const test::CommandResult& result) {
    for (const std::string& text : {result.out, result.error}) {
      for (const char* bad : {"\x1b", "\r", "\x07", "\xe2\x80\xae", "\xff", "\xc2\x9b"}) {
        EXPECT_THAT(text, Not(HasSubstr(bad))) << text;
      }
    }
    const std::size_t error = result.error.find("facezip: error: ");
    if (error != std::string::npos) {
      EXPECT_EQ(result.error.find('\n', error), result.error.size() - 1) << result.error;
    }
  }

  /// Replaces a text in a file.
  static void replaceIn(const fs::path& file, const std::string& from, const std::string& to) {
    std::string text = test::contentsOf(file);
    const std::size_t at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    io::writeTextFile(file, text.replace(at, from.size(), to));
  }

  const test::TemporaryDirectory folder_;
};

TEST_F(Names, OfAPackageDoNothingToATerminal) {
  replaceIn(folder_ / "package/package.json", "\"name\": \"capture\"",
            R"("name": "a\u001b[2Jb\n\u202ec\u009b31m\u0007")");
  const test::CommandResult info = runFacezip("info " + quoted(folder_ / "package"));
  ASSERT_EQ(info.exit_code, 0) << info.error;
  EXPECT_THAT(info.out, testing::StartsWith("a\\x1b[2Jb\\x0a\\u{202e}c\\u{9b}31m\\x07: 3 expressions"));
  expectHarmless(info);
  // Errors that quote it.
  io::writeTextFile(folder_ / "gain.json",
                    R"({"format": "facezip-gains", "version": 1, "package": "x\u001b[31m", "e\u001bx": 1})");
  const test::CommandResult gain = runFacezip("blend " + quoted(folder_ / "package") + " --weights '' -o " +
                                              quoted(folder_ / "x.png") + " --gain " + quoted(folder_ / "gain.json"));
  EXPECT_EQ(gain.exit_code, cli::kExitInput);
  expectHarmless(gain);
}

TEST_F(Names, OfFilesDoNothingToATerminal) {
  const std::string name = "a\nb\x1b[31m\r\xe2\x80\xae\xff";
  fs::copy(folder_ / "capture", folder_ / name, fs::copy_options::recursive);
  const std::string bad = quoted(folder_ / name);
  for (const std::string& command :
       {"compress " + bad + " -o " + bad, "compress " + bad + " -o " + quoted(folder_ / "p") + " --report " + bad,
        "info " + bad, "blend " + bad + " --weights '' -o x.png", "view " + bad,
        "export " + bad + " --target gltf -o x",
        "blend " + quoted(folder_ / "package") + " --weights " + test::quoted(name + "=1") + " -o x.png",
        "blend " + quoted(folder_ / "package") + " --weights '' -o " + quoted(folder_ / (name + ".xyz")),
        compress("p") + " --region " + bad, compress("p") + " --importance " + bad,
        compress("p") + " --maps " + test::quoted(name), compress("p") + " --unit " + test::quoted(name),
        compress("p") + " --mask-radius " + test::quoted(name), compress("p") + " --masks " + test::quoted(name),
        compress("p") + " --no-such-option-" + test::quoted(name), test::quoted(name)}) {
    const test::CommandResult result = runFacezip(command);
    EXPECT_NE(result.exit_code, 0) << command;
    EXPECT_NE(result.exit_code, cli::kExitInternal) << command << ": " << result.error;
    expectHarmless(result);
  }
  const test::CommandResult device = runFacezip(compress("p") + " --device " + bad);  // lists devices, a line each
  EXPECT_EQ(device.exit_code, cli::kExitDevice);
  EXPECT_THAT(device.error, testing::AllOf(HasSubstr("\\x1b[31m"), Not(HasSubstr("\x1b"))));
  // Notes and results, too: a capture and a package may well have such names.
  io::writeTextFile(folder_ / name / "capture.json", R"({"name": "good"})");
  fs::create_directory(folder_ / name / "expressions");
  fs::copy_file(folder_ / "capture/neutral.obj", folder_ / name / "expressions/x\x1b[31m.obj");
  const test::CommandResult made =
      runFacezip("compress " + bad + " -o " + quoted(folder_ / (name + "2")) + " --unit m --mask-radius 5cm");
  EXPECT_EQ(made.exit_code, 0) << made.error;
  EXPECT_THAT(made.error, HasSubstr("x\\x1b[31m.obj matches no expression"));
  expectHarmless(made);
}

TEST_F(Names, OfOutputsMayBeLong) {
  const std::string face = quoted(folder_ / "package") + " -o ";
  for (const std::size_t length : {200u, 240u, 255u}) {
    const auto named = [&](const std::string& extension) {
      return folder_ / (std::string(length - extension.size(), 'n') + extension);
    };
    std::string command = compress(named("").filename()) + " --report " + test::quoted(named(".json"));
    EXPECT_EQ(runFacezip(command).exit_code, 0) << length << runFacezip(command).error;
    EXPECT_EQ(runFacezip(command).exit_code, 0) << length << ", over an earlier one";
    for (const std::string& arguments :
         {"blend " + face + test::quoted(named(".png")) + " --weights e00=1",
          "export " + face + test::quoted(named(".x")) + " --target gltf",
          "reconstruct " + face + test::quoted(named(".d")), "view " + face + test::quoted(named(".v"))}) {
      const test::CommandResult result = runFacezip(arguments);
      EXPECT_EQ(result.exit_code, 0) << length << ": " << result.error;
    }
  }
  const test::CommandResult longer = runFacezip(compress(std::string(256, 'n')));
  EXPECT_EQ(longer.exit_code, cli::kExitOutput);
  EXPECT_THAT(longer.error, HasSubstr("File name too long"));
  const test::CommandResult report = runFacezip(compress("p") + " --report " + quoted(folder_ / std::string(256, 'n')));
  EXPECT_EQ(report.exit_code, cli::kExitOutput);
  EXPECT_THAT(report.error, HasSubstr("File name too long"));
}

TEST_F(Names, AHomeThatCannotBeWrittenToIsNoMissingDevice) {
  fs::remove_all(folder_ / "package");
  io::writeTextFile(folder_ / "file", "no folder");
  fs::create_directory(folder_ / "tmp");
  for (const fs::path& home : {fs::path("/proc/nowhere"), folder_ / "file"}) {
    const std::string environment =
        "env -u XDG_CACHE_HOME -u FACEZIP_CACHE_DIR -u POCL_CACHE_DIR HOME=" + quoted(home) +
        " TMPDIR=" + quoted(folder_ / "tmp");
    const test::CommandResult result = runFacezip(compress("package") + " --device pocl", environment);
    EXPECT_EQ(result.exit_code, 0) << result.error;
    EXPECT_EQ(runFacezip("devices", environment).exit_code, 0);
    EXPECT_TRUE(fs::is_empty(folder_ / "tmp")) << "what PoCL got there is gone";
    const test::CommandResult nowhere = runFacezip("devices", environment + " TMPDIR=/proc/nowhere");
    if (nowhere.exit_code != 0) {  // another device may be there
      EXPECT_EQ(nowhere.exit_code, cli::kExitDevice);
      EXPECT_THAT(nowhere.error, testing::AllOf(HasSubstr(home.string()), HasSubstr("set POCL_CACHE_DIR")));
      EXPECT_THAT(nowhere.error, Not(HasSubstr("install")));
    }
  }
  const test::CommandResult told = runFacezip(compress("package") + " --device pocl", "POCL_CACHE_DIR=/proc/nowhere");
  EXPECT_EQ(told.exit_code, cli::kExitDevice);
  EXPECT_THAT(told.error, Not(HasSubstr("install")));
}

TEST_F(Names, TheDirectoryForTemporaryFilesIsNamedWhereItIsMissing) {
  const std::string both = quoted(folder_ / "capture") + " " + quoted(folder_ / "package");
  for (const std::string& command :
       {"evaluate " + both + " --baselines paper", "report " + both + " -o " + quoted(folder_ / "page.html")}) {
    const test::CommandResult missing = runFacezip(command, "TMPDIR=" + quoted(folder_ / "nowhere"));
    EXPECT_EQ(missing.exit_code, cli::kExitOutput) << missing.error;
    EXPECT_THAT(missing.error, testing::AllOf(HasSubstr("nowhere"), HasSubstr("TMPDIR")));
    // Files that are called as folders in there were, or are.
    fs::create_directory(folder_ / "tmp");
    for (const char* name : {"facezip-baseline", "facezip-report", "facezip-scratch"}) {
      io::writeTextFile(folder_ / "tmp" / name, "in the way");
    }
    const test::CommandResult result = runFacezip(command, "TMPDIR=" + quoted(folder_ / "tmp"));
    EXPECT_EQ(result.exit_code, 0) << result.error;
    EXPECT_EQ(test::filesBelow(folder_ / "tmp").size(), 3u);
    fs::remove_all(folder_ / "tmp");
  }
}

}  // namespace
}  // namespace facezip
