#include "blocks/bc_decoder.hpp"

namespace facezip::blocks {
namespace {

std::uint64_t bitsOf(std::span<const std::byte, 8> block) {
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < 8; ++i) bits |= std::to_integer<std::uint64_t>(block[i]) << (8 * i);
  return bits;
}

std::array<std::uint8_t, 4> colourOf(unsigned word) {
  const unsigned red = word >> 11 & 31u;
  const unsigned green = word >> 5 & 63u;
  const unsigned blue = word & 31u;
  return {static_cast<std::uint8_t>(red << 3 | red >> 2), static_cast<std::uint8_t>(green << 2 | green >> 4),
          static_cast<std::uint8_t>(blue << 3 | blue >> 2), 255};
}

}  // namespace

BlockColours decodeBc1(std::span<const std::byte, 8> block) {
  const std::uint64_t bits = bitsOf(block);
  const auto first = static_cast<unsigned>(bits & 0xffffu);
  const auto second = static_cast<unsigned>(bits >> 16 & 0xffffu);
  std::array<std::array<std::uint8_t, 4>, 4> palette{colourOf(first), colourOf(second)};
  for (std::size_t c = 0; c < 4; ++c) {
    const unsigned a = palette[0][c];
    const unsigned b = palette[1][c];
    palette[2][c] = static_cast<std::uint8_t>(first > second ? (2 * a + b + 1) / 3 : (a + b + 1) / 2);
    palette[3][c] = static_cast<std::uint8_t>(first > second ? (a + 2 * b + 1) / 3 : 0);
  }
  BlockColours colours;
  for (std::size_t t = 0; t < 16; ++t) colours[t] = palette[bits >> (32 + 2 * t) & 3u];
  return colours;
}

std::array<float, 16> decodeBc4(std::span<const std::byte, 8> block) {
  const std::uint64_t bits = bitsOf(block);
  const auto a = static_cast<float>(bits & 255u);
  const auto b = static_cast<float>(bits >> 8 & 255u);
  std::array<float, 8> palette{a, b};
  const int steps = a > b ? 7 : 5;
  for (int i = 1; i < steps; ++i) {
    palette[static_cast<std::size_t>(i + 1)] = a + static_cast<float>(i) * ((b - a) / static_cast<float>(steps));
  }
  if (steps == 5) {
    palette[6] = 0.0f;
    palette[7] = 255.0f;
  }
  std::array<float, 16> values;
  for (std::size_t t = 0; t < 16; ++t) values[t] = palette[bits >> (16 + 3 * t) & 7u];
  return values;
}

}  // namespace facezip::blocks
