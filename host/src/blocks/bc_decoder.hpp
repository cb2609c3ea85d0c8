// bc_decoder.hpp - single blocks of the BC formats.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace facezip::blocks {

/// Red, green, blue and alpha of the texels of a block, row by row.
using BlockColours = std::array<std::array<std::uint8_t, 4>, 16>;

/// Colours between the ends are rounded, halves upwards. Transparent texels of 3-colour blocks are black.
BlockColours decodeBc1(std::span<const std::byte, 8> block);
/// Values between the ends are not rounded.
std::array<float, 16> decodeBc4(std::span<const std::byte, 8> block);
/// Blocks without a mode are black and transparent.
BlockColours decodeBc7(std::span<const std::byte, 16> block);

}  // namespace facezip::blocks
