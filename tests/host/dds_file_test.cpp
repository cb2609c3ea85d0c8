#include "blocks/dds_file.hpp"

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <cmath>

#include "blocks/block_decoder.hpp"
#include "blocks/block_encoder.hpp"
#include "file_contents.hpp"
#include "photograph_like.hpp"
#include "temporary_directory.hpp"
#include "test_device.hpp"
#include "texture_on_disk.hpp"

namespace facezip::blocks {
namespace {

namespace fs = std::filesystem;

TEST(DdsFile, OfOthersByItsFields) {
  const test::TemporaryDirectory folder;
  const BlockTexture texture{BlockFormat::kBc7, 64, 32, 3};
  const fs::path path = folder / "a.dds";
  test::writeTexture(path, texture, test::anyBlocks(texture));
  const std::string bytes = test::contentsOf(path);
  const test::ForeignField fields[] = {{0, 0, ""},
                                       {4, 125, "dwSize"},
                                       {8, 0, "was read"},  // flags, which readers shall not trust
                                       {12, 0, "dwHeight"},
                                       {16, 16385, "dwWidth"},
                                       {16, 16384, ""},  // too short for that
                                       {20, 7, "was read"},
                                       {24, 2, "dwDepth"},
                                       {28, 8, "dwMipMapCount"},
                                       {28, 0, ""},  // one level: bytes are left
                                       {76, 0, "ddspf.dwSize"},
                                       {80, 0x41, "ddspf.dwFourCC"},
                                       {84, 0x31545844, "ddspf.dwFourCC"},  // DXT1
                                       {112, 0x200, "miscFlag"},
                                       {128, 28, "dxgiFormat"},
                                       {128, 0, "dxgiFormat"},
                                       {132, 4, "resourceDimension"},
                                       {136, 4, "miscFlag"},
                                       {140, 2, "arraySize"},
                                       {140, 0xffffffff, "arraySize"},
                                       {144, 2, "miscFlags2"}};
  for (const test::ForeignField& field : fields) {
    std::string other = bytes;
    test::replaceWord(other, field.offset, field.value);
    EXPECT_EQ(test::itemOf("a.dds", other), field.item) << "at " << field.offset << ": " << field.value;
  }
}

/// Another's decoder and another's idea of the container. It widens BC1's 5 and 6 bits by a multiplication, which may
/// differ by one from repeating the upper bits, and rounds BC4 and BC5. It knows BC1 by the older header alone, which
/// ends before the DX10 header begins.
TEST(DdsFile, OpenImageIoReadsIt) {
  const test::TemporaryDirectory folder;
  const int width = 60, height = 36;
  const std::vector<std::uint8_t> colours = test::photographLike(width, height);
  for (const auto& [format, channels] :
       {std::pair{BlockFormat::kBc1, 3}, {BlockFormat::kBc4, 1}, {BlockFormat::kBc5, 2}, {BlockFormat::kBc7, 3}}) {
    const BlockTexture texture{format, width, height, 2};
    test::BlockLevels levels;
    for (int level = 0; level < texture.levels; ++level) {
      // The upper left of the picture will do for the smaller level.
      const int columns = levelSide(width, level), rows = levelSide(height, level);
      std::vector<std::uint8_t> texels;
      for (int y = 0; y < rows; ++y) {
        for (int x = 0; x < columns; ++x) {
          for (int c = 0; c < channels; ++c)
            texels.push_back(colours[static_cast<std::size_t>((y * width + x) * 3 + c)]);
        }
      }
      levels.emplace_back(levelBytes(texture, level));
      makeBlockEncoder(test::testDevice().context(), {format, channels, Quality::kFast})
          ->encode({columns, rows, channels, std::span<const std::uint8_t>(texels), {}}, levels.back(), {});
    }
    test::writeTexture(folder / "a.dds", texture, levels);
    if (format == BlockFormat::kBc1) {
      std::string bytes = test::contentsOf(folder / "a.dds");
      test::save(folder / "a.dds", bytes.erase(128, 20).replace(84, 4, "DXT1"));
    }
    const auto input = OIIO::ImageInput::open((folder / "a.dds").string());
    ASSERT_TRUE(input) << infoOf(format).name << ": " << OIIO::geterror();
    for (int level = 0; level < texture.levels; ++level) {
      ASSERT_TRUE(input->seek_subimage(0, level)) << infoOf(format).name;
      const OIIO::ImageSpec spec = input->spec();
      const int columns = levelSide(width, level), rows = levelSide(height, level);
      ASSERT_EQ(spec.width, columns);
      ASSERT_EQ(spec.height, rows);
      ASSERT_GE(spec.nchannels, channels);
      const auto all = static_cast<std::size_t>(columns * rows);
      std::vector<std::uint8_t> theirs(all * static_cast<std::size_t>(spec.nchannels));
      ASSERT_TRUE(input->read_image(0, level, 0, spec.nchannels, OIIO::TypeDesc::UINT8, theirs.data()))
          << input->geterror();
      std::vector<float> ours(all * static_cast<std::size_t>(channels));
      makeBlockDecoder(format, channels)
          ->decode(columns, rows, levels[static_cast<std::size_t>(level)], std::span(ours));
      float largest = 0.0f;
      for (std::size_t p = 0; p < all; ++p) {
        for (int c = 0; c < channels; ++c) {
          const std::size_t at = p * static_cast<std::size_t>(spec.nchannels) + static_cast<std::size_t>(c);
          const std::size_t own = p * static_cast<std::size_t>(channels) + static_cast<std::size_t>(c);
          largest = std::max(largest, std::abs(static_cast<float>(theirs[at]) - ours[own]));
        }
      }
      EXPECT_LE(largest, format == BlockFormat::kBc7 ? 0.0f : 1.0f) << infoOf(format).name << ", level " << level;
    }
  }
}

}  // namespace
}  // namespace facezip::blocks
