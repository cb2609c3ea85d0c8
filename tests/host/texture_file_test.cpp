// Textures of blocks on disk: what was written is read back, and what strangers wrote is read or refused, within
// bounds.
#include "blocks/texture_file.hpp"

#include <gtest/gtest.h>

#include "file_contents.hpp"
#include "temporary_directory.hpp"
#include "texture_on_disk.hpp"

namespace facezip::blocks {
namespace {

namespace fs = std::filesystem;

TEST(BlockTexture, SidesAreHalvedAndRoundedDown) {
  EXPECT_EQ(mostLevels(1, 1), 1);
  EXPECT_EQ(mostLevels(1024, 1), 11);
  EXPECT_EQ(mostLevels(3, 1023), 10);
  EXPECT_EQ(mostLevels(65536, 65536), 17);
  EXPECT_EQ(levelSide(37, 1), 18);
  EXPECT_EQ(levelSide(37, 5), 1);
  EXPECT_EQ(levelSide(3, 9), 1);
  const BlockTexture texture{BlockFormat::kAstc6x6, 37, 13, 3};
  EXPECT_EQ(blockRows(texture, 0), 3);
  EXPECT_EQ(blockRowBytes(texture, 1), 3u * 16u);
  EXPECT_EQ(levelBytes(texture, 2), 2u * 16u);
}

TEST(TextureFile, EveryFormatComesBack) {
  const test::TemporaryDirectory folder;
  for (const BlockFormatInfo& info : blockFormats()) {
    for (const char* name : test::kContainers) {
      if (isAstc(info.format) && std::string(name) == "texture.dds") continue;
      for (const auto& [width, height] : {std::pair{1, 1}, {5, 3}, {64, 64}, {93, 41}, {1, 70}}) {
        for (const bool srgb : {false, true}) {
          if (srgb && info.vk_srgb == 0) continue;
          for (const int levels : {1, mostLevels(width, height)}) {
            const BlockTexture texture{info.format, width, height, levels, srgb};
            const test::BlockLevels blocks = test::anyBlocks(texture);
            test::writeTexture(folder / name, texture, blocks);
            const TextureFileReader reader = test::openTexture(folder / name);
            ASSERT_EQ(reader.texture(), texture) << info.name << " in " << name;
            for (int level = 0; level < levels; ++level) {
              ASSERT_EQ(reader.readLevel(level), blocks[static_cast<std::size_t>(level)])
                  << info.name << " in " << name;
            }
          }
        }
      }
    }
  }
}

TEST(TextureFile, RowsAreReadAlone) {
  const test::TemporaryDirectory folder;
  const BlockTexture texture{BlockFormat::kBc1, 50, 61, 6};
  const test::BlockLevels blocks = test::anyBlocks(texture);
  for (const char* name : test::kContainers) {
    test::writeTexture(folder / name, texture, blocks);
    const TextureFileReader reader = test::openTexture(folder / name);
    for (const auto& [level, begin, end] : {std::array{0, 5, 9}, {0, 15, 16}, {0, 3, 3}, {1, 0, 2}, {5, 0, 1}}) {
      const std::size_t row_bytes = blockRowBytes(texture, level);
      std::vector<std::byte> rows(static_cast<std::size_t>(end - begin) * row_bytes);
      reader.readRows(level, begin, end, rows);
      const auto expected = std::span(blocks[static_cast<std::size_t>(level)])
                                .subspan(static_cast<std::size_t>(begin) * row_bytes, rows.size());
      EXPECT_TRUE(std::equal(rows.begin(), rows.end(), expected.begin())) << name << ", level " << level;
    }
  }
}

TEST(TextureFile, CutShortAnywhereItIsRefused) {
  const test::TemporaryDirectory folder;
  const BlockTexture texture{BlockFormat::kBc7, 9, 6, 4};
  for (const char* name : test::kContainers) {
    test::writeTexture(folder / name, texture, test::anyBlocks(texture));
    const std::string bytes = test::contentsOf(folder / name);
    for (std::size_t length = 0; length < bytes.size(); ++length) {
      ASSERT_THROW(test::openBytes(name, bytes.substr(0, length)), InputError) << name << " of " << length << " bytes";
    }
    EXPECT_THROW(test::openBytes(name, bytes + '\0'), InputError) << name << " with a byte too many";
  }
}

TEST(TextureFile, FlippedBitsAreRefusedOrAnotherTexture) {
  const test::TemporaryDirectory folder;
  const BlockTexture texture{BlockFormat::kAstc5x5, 23, 14, 5};
  const BlockTexture of_dds{BlockFormat::kBc1, 23, 14, 5};
  for (const char* name : test::kContainers) {
    const BlockTexture& written = std::string(name) == "texture.dds" ? of_dds : texture;
    const test::BlockLevels blocks = test::anyBlocks(written);
    test::writeTexture(folder / name, written, blocks);
    const std::string bytes = test::contentsOf(folder / name);
    const std::size_t header = bytes.size() - blocks[0].size();
    int refused = 0;
    for (std::size_t bit = 0; bit < 8 * header; ++bit) {
      std::string damaged = bytes;
      damaged[bit / 8] = static_cast<char>(damaged[bit / 8] ^ 1 << (bit % 8));
      try {
        const TextureFileReader reader = test::openBytes(name, damaged);
        // Another size of as many blocks, another format of as many bytes, or a field that says nothing of the blocks.
        for (int level = 0; level < reader.texture().levels; ++level) reader.readLevel(level);
        ASSERT_EQ(levelBytes(reader.texture(), 0), blocks[0].size()) << name << ", bit " << bit;
      } catch (const InputError& error) {
        ++refused;
        ASSERT_LT(std::string(error.what()).size(), 1000u);
      }
    }
    EXPECT_GT(refused, 300) << name;
  }
}

TEST(TextureFile, ContainersRefuseWhatTheyCannotHold) {
  const test::TemporaryDirectory folder;
  using Texture = BlockTexture;
  EXPECT_THROW(TextureFileWriter(folder / "a.dds", Texture{BlockFormat::kAstc6x6, 64, 64, 1}), InputError);
  EXPECT_THROW(TextureFileWriter(folder / "a.dds", Texture{BlockFormat::kBc7, 16385, 4, 1}), InputError);
  EXPECT_THROW(TextureFileWriter(folder / "a.ktx2", Texture{BlockFormat::kBc7, 4, 65537, 1}), InputError);
  EXPECT_THROW(TextureFileWriter(folder / "a.ktx2", Texture{BlockFormat::kBc5, 4, 4, 1, true}), InputError);
  EXPECT_THROW(TextureFileWriter(folder / "a.png", Texture{BlockFormat::kBc7, 4, 4, 1}), InputError);
  EXPECT_TRUE(fs::is_empty(folder.path()));
  EXPECT_THROW(test::openTexture(folder / "missing.ktx2"), InputError);
  fs::create_directory(folder / "folder.ktx2");
  EXPECT_THROW(test::openTexture(folder / "folder.ktx2"), InputError);
}

TEST(TextureFile, NothingHalfWrittenIsLeft) {
  const test::TemporaryDirectory folder;
  const BlockTexture texture{BlockFormat::kBc7, 16, 16, 2};
  const test::BlockLevels blocks = test::anyBlocks(texture);
  for (const char* name : test::kContainers) {
    {
      TextureFileWriter writer(folder / name, texture);
      writer.append(0, blocks[0]);
      writer.append(1, blocks[1]);
      EXPECT_THROW(test::openTexture(folder / name), InputError) << "all blocks, but not closed";
    }
    EXPECT_FALSE(fs::exists(folder / name));
  }
  if (!fs::exists("/dev/full")) return;
  fs::create_symlink("/dev/full", folder / "full.ktx2");
  {
    TextureFileWriter writer(folder / "full.ktx2", texture);
    EXPECT_THROW(writer.append(0, blocks[0]), OutputError);
  }
  EXPECT_TRUE(fs::exists("/dev/full"));
  EXPECT_THROW(TextureFileWriter(folder / "no_folder" / "a.ktx2", texture), OutputError);
}

TEST(TextureFile, AFileThatShrinksIsNoticed) {
  const test::TemporaryDirectory folder;
  const BlockTexture texture{BlockFormat::kBc7, 64, 64, 1};
  test::writeTexture(folder / "a.ktx2", texture, test::anyBlocks(texture));
  const TextureFileReader reader = test::openTexture(folder / "a.ktx2");
  fs::resize_file(folder / "a.ktx2", 600);
  EXPECT_THROW(reader.readLevel(0), InputError);
}

}  // namespace
}  // namespace facezip::blocks
