// What the command says to those who mistype, and what it leaves on their terminals.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "exit_codes.hpp"
#include "facezip/error.hpp"
#include "host/sample_package.hpp"
#include "io/write_file.hpp"
#include "option_types.hpp"
#include "run_command.hpp"
#include "temporary_directory.hpp"
#include "terminal.hpp"

namespace facezip {
namespace {
using test::quoted;
using test::runFacezip;
using testing::HasSubstr;
using testing::Not;

std::string refusalOf(const std::string& arguments) {
  const test::CommandResult result = runFacezip(arguments);
  EXPECT_EQ(result.exit_code, cli::kExitUsage) << arguments;
  EXPECT_EQ(result.out, "") << arguments;
  EXPECT_TRUE(result.error.starts_with("facezip: error: ")) << result.error;
  return result.error;
}

TEST(Usage, AMisspeltCommandIsAnsweredWithTheNearest) {
  EXPECT_THAT(refusalOf("compres capture -o p"), HasSubstr("there is no command \"compres\"; did you mean compress?"));
  EXPECT_THAT(refusalOf("--quiet solve-weight a b"), HasSubstr("did you mean solve-weights?"));
  EXPECT_THAT(refusalOf("frobnicate"), testing::AllOf(HasSubstr("no command \"frobnicate\""), Not(HasSubstr("mean"))));
  EXPECT_THAT(refusalOf(""), HasSubstr("a command is required"));
  EXPECT_THAT(refusalOf("'\x1b[31m'"), HasSubstr("\"\\x1b[31m\""));
}

TEST(Usage, AMisspeltOptionIsAnsweredWithTheNearest) {
  EXPECT_THAT(refusalOf("compress capture -o p --target-rsme 1"),
              HasSubstr("compress has no option --target-rsme; did you mean --target-rmse?"));
  EXPECT_THAT(refusalOf("info p --qiet"), HasSubstr("did you mean --quiet?"));
  EXPECT_THAT(refusalOf("blend p --wieghts=a=1 -o f.png"), HasSubstr("no option --wieghts; did you mean --weights?"));
  EXPECT_THAT(refusalOf("info p --everything"), Not(HasSubstr("mean")));
}

TEST(Usage, OptionsThatGoTogetherOrNotSayWhatToDo) {
  EXPECT_THAT(refusalOf("blend p -o f.png"), HasSubstr("what to blend, --weights NAME=VALUE,... or --animation"));
  EXPECT_THAT(refusalOf("blend p -o f.png --weights a=1 --animation c.csv"),
              HasSubstr("--weights excludes --animation: leave one of them out"));
  EXPECT_THAT(refusalOf("compress c -o p --budget 1MB --differences 2"), HasSubstr("leave one of them out"));
  EXPECT_THAT(refusalOf("evaluate c p --picture-map albedo"), HasSubstr("--picture-map requires --picture"));
}

TEST(Sizes, HaveUnitsInAnyCase) {
  const auto bytes = [](const char* text) { return cli::parseBytes("--budget", text); };
  EXPECT_EQ(bytes("1KB"), 1000u);
  EXPECT_EQ(bytes("1kb"), 1000u);
  EXPECT_EQ(bytes("1.5 GB"), 1500000000u);
  EXPECT_EQ(bytes("2gib"), std::uint64_t{2} << 30);
  EXPECT_EQ(bytes("3  MiB"), 3u << 20);
  EXPECT_EQ(bytes("40B"), 40u);
  for (const char* text :
       {"", "MB", "-1MB", "1 M B", "1mbit", "nanMB", "1e30GB", "0x10MB", "1 MB x", "0.5B", "1\tMB"}) {
    EXPECT_THROW(bytes(text), InputError) << text;
  }
  try {
    bytes("40");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "--budget: expected a size with its unit, got 40; 40MiB? 40B are bytes");
  }
}

/// What the command writes to a terminal, as both its streams.
std::string onTerminal(const std::string& arguments) {
  // "$0" "$@" are the command and its arguments, which `script` wants as one text.
  const test::CommandResult result = runFacezip(
      arguments, "bash -c 'exec script --quiet --return --command \"$(printf \"%q \" \"$0\" \"$@\")\" /dev/null'");
  EXPECT_EQ(result.exit_code, 0) << result.out;
  return result.out;
}

TEST(Terminal, ProgressIsClearedBeforeAnythingElse) {
  const test::TemporaryDirectory folder;
  test::SamplePackage sample = test::makeSample();
  test::writeSample(sample, folder / "package");
  for (const std::string& command :
       {"info " + quoted(folder / "package"),
        "reconstruct " + quoted(folder / "package") + " --output " + quoted(folder / "decoded")}) {
    std::string text = onTerminal(command);
    ASSERT_THAT(text, HasSubstr(" ...")) << "no progress was shown";
    // Each line of progress ends in "..." and is cleared.
    for (std::size_t at = text.find(" ..."); at != std::string::npos; at = text.find(" ...", at + 1)) {
      EXPECT_EQ(text.substr(at + 4, 4), "\r\x1b[K") << text;
    }
  }
}

TEST(Terminal, NoNoteIsPrintedTwice) {
  testing::internal::CaptureStderr();
  {
    cli::TerminalProgress progress(/*quiet=*/false);
    for (const char* text : {"one", "other", "one"}) progress.note(text);
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "facezip: one\nfacezip: other\n");
}

}  // namespace
}  // namespace facezip
