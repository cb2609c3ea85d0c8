#include "blocks/block_format.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <string>

#include "facezip/error.hpp"

namespace facezip::blocks {
namespace {

TEST(BlockFormat, NamesAreFoundAndOthersRefused) {
  std::set<std::string_view> names;
  std::set<std::uint32_t> numbers;
  for (const BlockFormatInfo& info : blockFormats()) {
    EXPECT_EQ(blockFormatOf(info.name, "--texture-format"), info.format);
    EXPECT_EQ(&infoOf(info.format), &info);
    EXPECT_TRUE(names.insert(info.name).second);
    EXPECT_TRUE(numbers.insert(info.vk_unorm).second);
    EXPECT_TRUE(info.vk_srgb == 0 || numbers.insert(info.vk_srgb).second);
  }
  EXPECT_EQ(blockFormats().size(), 18u);
  for (const char* unknown : {"", "BC7", "bc2", "astc", "astc-6x7", "bc7 "}) {
    try {
      blockFormatOf(unknown, "--texture-format");
      FAIL() << unknown;
    } catch (const InputError& error) {
      EXPECT_EQ(error.parts().got, unknown);
      EXPECT_THAT(error.what(), testing::HasSubstr("--texture-format"));
      EXPECT_THAT(error.what(), testing::HasSubstr("bc7, astc-4x4"));
    }
  }
}

TEST(BlockFormat, BytesOfSizesThatDoNotDivide) {
  EXPECT_EQ(blockBytes(BlockFormat::kBc7, 4, 4), 16u);
  EXPECT_EQ(blockBytes(BlockFormat::kBc7, 5, 4), 32u);
  EXPECT_EQ(blockBytes(BlockFormat::kBc1, 1, 9), 24u);
  EXPECT_EQ(blockBytes(BlockFormat::kAstc6x6, 1024, 1024), 171u * 171u * 16u);
  EXPECT_EQ(blockBytes(BlockFormat::kAstc12x10, 13, 10), 32u);
  EXPECT_EQ(blockBytes(BlockFormat::kBc7, 65536, 65536), std::size_t{1} << 32);
}

}  // namespace
}  // namespace facezip::blocks
