// Standard output and error that are full, or closed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "exit_codes.hpp"
#include "file_contents.hpp"
#include "run_command.hpp"
#include "small_capture.hpp"
#include "temporary_directory.hpp"

namespace facezip {
namespace {
using test::quoted;
using testing::HasSubstr;

/// Runs facezip with a redirection that a shell makes last.
test::CommandResult runRedirected(const std::string& arguments, const std::string& redirection) {
  return test::runFacezip(arguments, "sh -c '\"$0\" \"$@\" " + redirection + "'");
}

class StandardStreams : public testing::Test {
 protected:
  void SetUp() override { test::writeSmallCapture(folder_ / "capture", {.expressions = 3, .width = 48, .height = 48}); }

  std::string compressTo(const std::string& package) const {
    return "compress " + quoted(folder_ / "capture") + " --output " + quoted(folder_ / package) +
           " --unit m --mask-radius 5cm --restarts 3 --cluster-restarts 3";
  }

  const test::TemporaryDirectory folder_;
};

TEST_F(StandardStreams, NotesThatCannotBeWrittenEndNothing) {
  const test::CommandResult heard = test::runFacezip(compressTo("heard"));
  EXPECT_EQ(heard.exit_code, cli::kExitSuccess);
  EXPECT_THAT(heard.error, HasSubstr("facezip: ")) << "there must be a note";
  EXPECT_EQ(runRedirected(compressTo("full"), "2>/dev/full").exit_code, cli::kExitSuccess);
  EXPECT_EQ(runRedirected(compressTo("closed"), ">&- 2>&-").exit_code, cli::kExitSuccess);
  EXPECT_EQ(test::filesOf(folder_ / "full"), test::filesOf(folder_ / "heard"));
  EXPECT_EQ(test::filesOf(folder_ / "closed"), test::filesOf(folder_ / "heard"));
}

TEST_F(StandardStreams, ErrorsThatCannotBeWrittenKeepTheirExitCode) {
  const std::string info = "info " + quoted(folder_ / "nothing");
  EXPECT_EQ(runRedirected(info, "2>/dev/full").exit_code, cli::kExitInput);
  EXPECT_EQ(runRedirected(info, "2>&-").exit_code, cli::kExitInput);
}

TEST_F(StandardStreams, ResultsThatCannotBeWrittenAreAnError) {
  for (const std::string& arguments : {std::string("devices"), std::string("--help"), compressTo("package")}) {
    const test::CommandResult result = runRedirected(arguments, ">/dev/full");
    EXPECT_EQ(result.exit_code, cli::kExitOutput) << arguments;
    EXPECT_THAT(result.error, HasSubstr("facezip: error: standard output: cannot write: No space left on device"));
  }
}

}  // namespace
}  // namespace facezip
