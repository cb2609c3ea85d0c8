#include "blocks/mipped_texture_writer.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "temporary_directory.hpp"
#include "test_device.hpp"

namespace facezip::blocks {
namespace {

class MippedTextureWriterTest : public testing::TestWithParam<BlockFormat> {};

TEST_P(MippedTextureWriterTest, LevelsAreMeansOfWhatTheBlocksDecodeTo) {
  constexpr int kWidth = 90, kHeight = 107, kChannels = 3;
  EncoderOptions options;
  options.format = GetParam();
  std::vector<float> texels;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      for (int c = 0; c < kChannels; ++c) {
        texels.push_back(128.0f + 90.0f * std::sin(0.05f * static_cast<float>(x) + 0.03f * static_cast<float>(y + c)));
      }
    }
  }
  device::DeviceContext& context = test::testDevice().context();
  const auto encoder = makeBlockEncoder(context, options);
  const test::TemporaryDirectory folder;
  const std::filesystem::path file = folder / "a.ktx2";
  MippedTextureWriter writer(context, file, kWidth, kHeight, options);
  // Bands of whole blocks of 4, 5 and 6 rows.
  for (int begin = 0; begin < kHeight; begin += 60) {
    const int rows = std::min(60, kHeight - begin);
    const auto part = std::span<const float>(texels).subspan(static_cast<std::size_t>(begin * kWidth * kChannels),
                                                             static_cast<std::size_t>(rows * kWidth * kChannels));
    std::vector<std::byte> blocks(blockBytes(GetParam(), kWidth, rows));
    encoder->encode({kWidth, rows, kChannels, part, {}}, blocks, {});
    writer.append(rows, blocks, std::vector<float>(static_cast<std::size_t>(rows * kWidth), 1.0f));
  }
  writer.close();
  const TextureFileReader reader(file, InputFile(file, "a texture"));
  ASSERT_EQ(reader.texture().levels, mostLevels(kWidth, kHeight));
  const auto decoder = makeBlockDecoder(GetParam(), kChannels);
  const auto level = [&](int l) {
    const int width = levelSide(kWidth, l), height = levelSide(kHeight, l);
    std::vector<float> decoded(static_cast<std::size_t>(width * height * kChannels));
    decoder->decode(width, height, reader.readLevel(l), std::span(decoded));
    return decoded;
  };
  const std::vector<float> whole = level(0);
  const std::vector<float> half = level(1);
  for (int y = 0; y < kHeight / 2; ++y) {
    for (int x = 0; x < kWidth / 2; ++x) {
      const auto at = [&](int i, int j) {
        return whole[static_cast<std::size_t>(((2 * y + j) * kWidth + 2 * x + i) * 3)];
      };
      const float mean = (at(0, 0) + at(1, 0) + at(0, 1) + at(1, 1)) / 4.0f;
      // The last of an odd number of rows has a share, too; what a smooth picture loses in blocks is small, but for
      // BC1, whose ends of 5 bits do not follow three channels apart.
      EXPECT_NEAR(half[static_cast<std::size_t>((y * (kWidth / 2) + x) * 3)], mean,
                  GetParam() == BlockFormat::kBc1 ? 20.0f : 6.0f)
          << x << " " << y;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Formats, MippedTextureWriterTest,
                         testing::Values(BlockFormat::kBc1, BlockFormat::kBc7, BlockFormat::kAstc5x5,
                                         BlockFormat::kAstc6x6),
                         [](const auto& format) {
                           std::string name(blockFormatName(format.param));
                           std::erase(name, '-');
                           return name;
                         });

}  // namespace
}  // namespace facezip::blocks
