#include "facezip/error.hpp"

#include <gtest/gtest.h>

namespace facezip {
namespace {

TEST(InputError, NamesFileItemExpectedGotAndCure) {
  const InputError error({"a.obj", "line 3", "three coordinates", "two", "export it again"});
  EXPECT_STREQ(error.what(), "a.obj: line 3: expected three coordinates, got two; export it again");
}

TEST(InputError, LeavesOutWhatIsEmpty) {
  EXPECT_STREQ(InputError({"a.obj", "", "", "no such file", ""}).what(), "a.obj: got no such file");
  EXPECT_STREQ(InputError({"", "", "a number", "x", ""}).what(), "expected a number, got x");
}

TEST(OutputError, NamesFileReasonAndCure) {
  EXPECT_STREQ(OutputError("/x", "disk full", "free some").what(), "/x: cannot write: disk full; free some");
}

}  // namespace
}  // namespace facezip
