#include "blocks/block_decoder.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cassert>
#include <type_traits>
#include <vector>

#include "blocks/astc_codec.hpp"
#include "blocks/bc_decoder.hpp"

namespace facezip::blocks {
namespace {

/// [texel][channel] of one block.
using BlockTexels = std::array<std::array<float, 4>, 16>;

template <typename Value>
BlockTexels asFloats(const std::array<std::array<Value, 4>, 16>& colours) {
  BlockTexels texels;
  for (std::size_t t = 0; t < 16; ++t) std::copy(colours[t].begin(), colours[t].end(), texels[t].begin());
  return texels;
}

BlockTexels decodeBlock(BlockFormat format, const std::byte* block) {
  const std::span<const std::byte, 8> half(block, 8);
  if (format == BlockFormat::kBc1) return asFloats(decodeBc1(half));
  if (format == BlockFormat::kBc7) return asFloats(decodeBc7(std::span<const std::byte, 16>(block, 16)));
  BlockTexels texels{};
  for (std::size_t c = 0; c < (format == BlockFormat::kBc5 ? 2u : 1u); ++c) {
    const std::array<float, 16> values = decodeBc4(std::span<const std::byte, 8>(block + 8 * c, 8));
    for (std::size_t t = 0; t < 16; ++t) texels[t][c] = values[t];
  }
  return texels;
}

template <typename Sample>
Sample stored(float value) {
  if constexpr (std::is_same_v<Sample, float>) return value;
  return static_cast<Sample>(value + 0.5f);
}

class BcDecoder final : public BlockDecoder {
 public:
  BcDecoder(BlockFormat format, int channels) : format_(format), channels_(channels) {}

  void decode(int width, int rows, std::span<const std::byte> blocks, std::span<float> texels) override {
    run(width, rows, blocks, texels);
  }
  void decode(int width, int rows, std::span<const std::byte> blocks, std::span<std::uint8_t> texels) override {
    run(width, rows, blocks, texels);
  }

 private:
  template <typename Sample>
  void run(int width, int rows, std::span<const std::byte> blocks, std::span<Sample> texels) const {
    assert(blocks.size() == blockBytes(format_, width, rows));
    assert(texels.size() ==
           static_cast<std::size_t>(width) * static_cast<std::size_t>(rows) * static_cast<std::size_t>(channels_));
    const int columns = blockCount(width, 4);
    const auto block_bytes = static_cast<std::size_t>(infoOf(format_).block_bytes);
    tbb::parallel_for(0, blockCount(rows, 4), [&](int y) {
      for (int x = 0; x < columns; ++x) {
        const std::size_t index =
            static_cast<std::size_t>(y) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(x);
        write(decodeBlock(format_, &blocks[index * block_bytes]), width, rows, x, y, texels);
      }
    });
  }

  template <typename Sample>
  void write(const BlockTexels& block, int width, int rows, int x, int y, std::span<Sample> texels) const {
    for (int row = 0; row < std::min(4, rows - 4 * y); ++row) {
      const std::size_t line =
          static_cast<std::size_t>(4 * y + row) * static_cast<std::size_t>(width) + static_cast<std::size_t>(4 * x);
      Sample* out = &texels[line * static_cast<std::size_t>(channels_)];
      for (int column = 0; column < std::min(4, width - 4 * x); ++column) {
        const auto& texel = block[static_cast<std::size_t>(4 * row + column)];
        for (int c = 0; c < channels_; ++c) *out++ = stored<Sample>(texel[static_cast<std::size_t>(c)]);
      }
    }
  }

  BlockFormat format_;
  int channels_;
};

class AstcDecoder final : public BlockDecoder {
 public:
  AstcDecoder(BlockFormat format, int channels)
      : codec_(format, channels), channels_(static_cast<std::size_t>(channels)) {}

  void decode(int width, int rows, std::span<const std::byte> blocks, std::span<float> texels) override {
    run(width, rows, blocks, texels, 255.0f);
  }
  void decode(int width, int rows, std::span<const std::byte> blocks, std::span<std::uint8_t> texels) override {
    run(width, rows, blocks, texels, std::uint8_t{1});
  }

 private:
  template <typename Sample>
  void run(int width, int rows, std::span<const std::byte> blocks, std::span<Sample> texels, Sample scale) {
    std::vector<Sample> rgba(static_cast<std::size_t>(width) * static_cast<std::size_t>(rows) * 4);
    assert(texels.size() == rgba.size() / 4 * channels_);
    codec_.decompress(width, rows, blocks, std::span(rgba));
    for (std::size_t p = 0; p < rgba.size() / 4; ++p) {
      for (std::size_t c = 0; c < channels_; ++c)
        texels[channels_ * p + c] = static_cast<Sample>(rgba[4 * p + c] * scale);
    }
  }

  AstcCodec codec_;
  std::size_t channels_;
};

}  // namespace

std::unique_ptr<BlockDecoder> makeBlockDecoder(BlockFormat format, int channels) {
  requireChannels(format, channels);
  if (isAstc(format)) return std::make_unique<AstcDecoder>(format, channels);
  return std::make_unique<BcDecoder>(format, channels);
}

}  // namespace facezip::blocks
