#include "blocks/ktx2_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "file_contents.hpp"
#include "temporary_directory.hpp"
#include "texture_on_disk.hpp"

namespace facezip::blocks {
namespace {

namespace fs = std::filesystem;

TEST(Ktx2File, IsAsTheSpecificationHasIt) {
  const test::TemporaryDirectory folder;
  const BlockTexture texture{BlockFormat::kBc5, 8, 8, 4};
  test::writeTexture(folder / "a.ktx2", texture, test::anyBlocks(texture));
  const std::string bytes = test::contentsOf(folder / "a.ktx2");
  const auto word = [&](std::size_t offset) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i)
      value |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[offset + i])) << (8 * i);
    return value;
  };
  EXPECT_EQ(bytes.substr(1, 6), "KTX 20");
  EXPECT_EQ(word(12), 141u);  // VK_FORMAT_BC5_UNORM_BLOCK
  // The smallest level is the first in the file, each at a multiple of its 16 bytes.
  std::uint32_t end = 0;
  for (std::size_t level = 4; level-- > 0;) {
    const std::uint32_t begin = word(80 + 24 * level);
    EXPECT_EQ(begin % 16, 0u);
    EXPECT_GE(begin, end);
    EXPECT_LT(begin - end, level == 3 ? 1000u : 16u);
    end = begin + word(80 + 24 * level + 8);
  }
  EXPECT_EQ(end, bytes.size());
  const std::size_t descriptor = word(48);
  EXPECT_EQ(word(descriptor), 4u + 24u + 2 * 16u);
  EXPECT_EQ(word(descriptor + 12) & 0xffffffu, 132u | 0u << 8 | 1u << 16);  // BC5, no primaries, linear
  EXPECT_EQ(word(descriptor + 16), 3u | 3u << 8);
  EXPECT_EQ(word(descriptor + 28), 0u | 63u << 16 | 0u << 24);
  EXPECT_EQ(word(descriptor + 44), 64u | 63u << 16 | 1u << 24);
  EXPECT_THAT(bytes, testing::HasSubstr(std::string("KTXorientation\0rd\0", 18)));
  EXPECT_THAT(bytes, testing::HasSubstr(std::string("KTXwriter\0facezip ", 18)));
}

TEST(Ktx2File, OfOthersByItsFields) {
  const test::TemporaryDirectory folder;
  const BlockTexture texture{BlockFormat::kBc7, 64, 32, 3};
  const fs::path path = folder / "a.ktx2";
  test::writeTexture(path, texture, test::anyBlocks(texture));
  const std::string bytes = test::contentsOf(path);
  const std::size_t descriptor = 80 + 3 * 24;
  const test::ForeignField fields[] = {{0, 0, ""},
                                       {12, 0, "vkFormat"},
                                       {12, 133, "vkFormat"},  // BC1 with transparent texels
                                       {12, 143, "vkFormat"},  // BC6H
                                       {12, 146, "data format descriptor, byte 14"},
                                       {16, 2, "typeSize"},
                                       {20, 0, "pixelWidth"},
                                       {20, 65537, "pixelWidth"},
                                       {20, 0xffffffff, "pixelWidth"},
                                       {20, 65536, "level 0: byteOffset"},
                                       {24, 0, "pixelHeight"},
                                       {28, 1, "pixelDepth"},
                                       {32, 1, "layerCount"},
                                       {36, 6, "faceCount"},
                                       {40, 0, "levelCount"},
                                       {40, 8, "levelCount"},
                                       {40, 0xffffffff, "levelCount"},
                                       {40, 4, "dfdByteOffset"},
                                       {44, 1, "supercompressionScheme"},
                                       {44, 2, "supercompressionScheme"},
                                       {48, 0, "dfdByteOffset"},
                                       {48, 0xfffffff0, "dfdByteOffset"},
                                       {52, 0xfffffff0, "dfdByteLength"},
                                       {56, 0xfffffff0, "kvdByteOffset"},
                                       {60, 0x7fffffff, "kvdByteLength"},
                                       {60, 0, "kvdByteOffset"},
                                       {64, 16, "sgdByteOffset"},
                                       {76, 1, "sgdByteLength"},
                                       {80, 16, "level 0: byteOffset"},
                                       {84, 1, "level 0: byteOffset"},
                                       {88, 16, "level 0: byteLength"},
                                       {96, 0, "level 0: uncompressedByteLength"},
                                       {104, 0x7fffffff, "level 1: byteOffset"},
                                       {descriptor, 60, "data format descriptor, byte 0"},
                                       {descriptor + 12, 134 | 1 << 16 | 1 << 24, "data format descriptor, byte 15"},
                                       {descriptor + 12, 134 | 2 << 16, "data format descriptor, byte 14"},
                                       {descriptor + 12, 134 | 1 << 8 | 1 << 16, "was read"},  // BT.709
                                       {descriptor + 44, 0xffffffff, "keys and values"},
                                       {descriptor + 44, 0, "keys and values"}};
  for (const test::ForeignField& field : fields) {
    std::string other = bytes;
    test::replaceWord(other, field.offset, field.value);
    EXPECT_EQ(test::itemOf("a.ktx2", other), field.item) << "at " << field.offset << ": " << field.value;
  }
  std::string turned = bytes;
  turned.replace(turned.find(std::string("rd\0", 3)), 2, "ru");
  EXPECT_EQ(test::itemOf("a.ktx2", turned), "KTXorientation");
  // A key that says nothing.
  turned.replace(turned.find("KTXorientation"), 14, "KTXorientatiom");
  EXPECT_EQ(test::itemOf("a.ktx2", turned), "was read");
}

TEST(Ktx2File, WithoutKeysIsRead) {
  const test::TemporaryDirectory folder;
  const BlockTexture texture{BlockFormat::kBc7, 4, 4, 1};
  const fs::path path = folder / "a.ktx2";
  test::writeTexture(path, texture, test::anyBlocks(texture));
  std::string bytes = test::contentsOf(path);
  const std::size_t descriptor_end = 80 + 24 + 44;
  bytes = bytes.substr(0, descriptor_end) + std::string(12, '\0') + bytes.substr(bytes.size() - 16);
  test::replaceWord(bytes, 56, 0);
  test::replaceWord(bytes, 60, 0);
  test::replaceWord(bytes, 80, 160);
  EXPECT_EQ(test::openBytes("a.ktx2", bytes).readLevel(0), test::anyBlocks(texture)[0]);
  // A swizzle of another's, in the place of that padding and some more.
  const std::string swizzle("\x10\0\0\0KTXswizzle\0rrr1\0", 20);
  std::string turned =
      bytes.substr(0, descriptor_end) + swizzle + std::string(8, '\0') + bytes.substr(bytes.size() - 16);
  test::replaceWord(turned, 56, static_cast<std::uint32_t>(descriptor_end));
  test::replaceWord(turned, 60, 20);
  test::replaceWord(turned, 80, 176);
  EXPECT_EQ(test::itemOf("a.ktx2", turned), "KTXswizzle");
  turned.replace(turned.find("rrr1"), 4, "rgba");
  EXPECT_EQ(test::itemOf("a.ktx2", turned), "was read");
}

}  // namespace
}  // namespace facezip::blocks
