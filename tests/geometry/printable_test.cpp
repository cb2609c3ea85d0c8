#include "facezip/printable.hpp"

#include <gtest/gtest.h>

#include <string>

#include "facezip/error.hpp"

namespace facezip {
namespace {

TEST(Printable, LeavesWhatCanBeRead) {
  for (const char* text : {"", "smile", "Lächeln", "笑顔", "jaw open (2).png", "C:\\faces", "\xf0\x9f\x98\x80"}) {
    EXPECT_EQ(printable(text), text);
  }
}

TEST(Printable, SpellsOutWhatATerminalWouldObey) {
  EXPECT_EQ(printable("a\x1b[31mb"), "a\\x1b[31mb");
  EXPECT_EQ(printable("a\nb\rc\td\x7f"), "a\\x0ab\\x0dc\\x09d\\x7f");
  EXPECT_EQ(printable(std::string_view("a\0b", 3)), "a\\x00b");
  EXPECT_EQ(printable("\xc2\x9b"
                      "31m"),
            "\\u{9b}31m");  // CSI in one character
  EXPECT_EQ(printable("face\xe2\x80\xae"
                      "gnp.exe"),
            "face\\u{202e}gnp.exe");
  EXPECT_EQ(printable("\xe2\x81\xa6x\xe2\x81\xa9\xef\xbb\xbf\xe2\x80\x8b\xe2\x80\xa8"),
            "\\u{2066}x\\u{2069}\\u{feff}\\u{200b}\\u{2028}");
}

TEST(Printable, SpellsOutBytesThatAreNoUtf8) {
  EXPECT_EQ(printable("f\xff.png"), "f\\xff.png");
  EXPECT_EQ(printable("\xc3"), "\\xc3");                    // cut
  EXPECT_EQ(printable("\xc0\xaf"), "\\xc0\\xaf");           // overlong '/'
  EXPECT_EQ(printable("\xed\xa0\x80"), "\\xed\\xa0\\x80");  // a surrogate
  EXPECT_EQ(printable("\xf4\x90\x80\x80"), "\\xf4\\x90\\x80\\x80");
}

TEST(Printable, TwiceIsOnce) {
  const std::string once = printable("a\x1b\xff\n\xe2\x80\xae");
  EXPECT_EQ(printable(once), once);
}

TEST(Printable, LinesMayStay) {
  EXPECT_EQ(printableLines("a\n\x1b"
                           "b\n"),
            "a\n\\x1bb\n");
}

TEST(Printable, ErrorsSayNamesSo) {
  const InputError input({"a\nb.obj", "line 1", "numbers", "\x1b[2J", "look\xff"});
  EXPECT_STREQ(input.what(), "a\\x0ab.obj: line 1: expected numbers, got \\x1b[2J; look\\xff");
  EXPECT_EQ(input.parts().file, "a\nb.obj") << "as it is, for programs";
  EXPECT_STREQ(OutputError("c\rd", "no\nroom").what(), "c\\x0dd: cannot write: no\\x0aroom");
}

}  // namespace
}  // namespace facezip
