// difference_texture_encode.hpp - problem of the step `difference_texture_encode`.
#pragma once

#include "codes/difference_texture_encode.hpp"
#include "problems/difference_texture.hpp"
#include "reference/difference_texture_encode.hpp"

namespace facezip::test {

/// Codes of 8 or 16 bits as numbers.
inline std::vector<double> codeNumbers(std::span<const std::byte> codes, int bits) {
  std::vector<double> numbers(codes.size() / toSize(bits / 8));
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    std::uint16_t wide = std::to_integer<std::uint16_t>(codes[i]);
    if (bits == 16) std::memcpy(&wide, codes.data() + 2 * i, 2);
    numbers[i] = wide;
  }
  return numbers;
}

/// Must move: textures in, codes out.
struct DifferenceTextureEncodeProblem : DifferenceTextureProblem {
  DifferenceTextureEncodeProblem(device::DeviceContext& device, const BandShape& band_shape,
                                 const TileMasks& tile_masks, int mask_count, int texture_count, int code_bits)
      : DifferenceTextureProblem(device, band_shape, tile_masks, mask_count, texture_count),
        bits(code_bits),
        encoder(device, texture_count),
        codes(codeLayout().size() * toSize(bits / 8)) {
    DifferenceTextureProblem::run();
    for (int plane = 0; plane < planes(); ++plane) {
      // Narrower than the values, so that some are clamped; the last plane is a constant.
      const double scale = (0.25 + 0.125 * plane) * 255.0 / largestCode();
      encoding.push_back({plane + 1 == planes() ? 0.0f : static_cast<float>(scale), -20.5f});
    }
  }

  double largestCode() const { return bits == 16 ? 65535.0 : 255.0; }
  /// [texture][row][column][channel]
  Layout<4> codeLayout() const { return Layout(table.textures, shape.rows, shape.width, shape.channels); }

  void run() { encoder.encode(tiles, shape, textures.textures(), encoding, bits, codes); }
  std::vector<double> result() const { return codeNumbers(codes, bits); }
  /// Where the values lie between the codes, in the order of result(); 0 has its code where there is no tile.
  std::vector<double> expectedPositions() const {
    std::vector<double> values(codeLayout().size(), 0.0);
    const std::vector<float> textures_of_tiles = DifferenceTextureProblem::result();
    for (std::size_t t = 0; t < tileCount(); ++t) {
      for (int plane = 0; plane < planes(); ++plane) {
        for (int p = 0; p < kTileTexels; ++p) {
          const int x = masks.tiles[t].x * kTileSide + p % kTileSide;
          const int y = masks.tiles[t].y * kTileSide + p / kTileSide;
          if (x >= shape.width || y >= shape.rows) continue;
          values[codeLayout()(plane / shape.channels, y, x, plane % shape.channels)] =
              static_cast<double>(textures_of_tiles[textureLayout()(t, plane, p)]);
        }
      }
    }
    for (std::size_t i = 0; i < values.size(); ++i) {
      const std::size_t texture = i / (codeLayout().size() / toSize(table.textures));
      const compress::TextureEncoding& e = encoding[toSize(shape.channels) * texture + i % toSize(shape.channels)];
      values[i] = reference::codePosition(values[i], static_cast<double>(e.scale), static_cast<double>(e.offset),
                                          largestCode());
    }
    return values;
  }

  double bytes() const { return textureBytes() + static_cast<double>(codes.size()); }

  int bits;
  compress::TextureEncoder encoder;
  std::vector<compress::TextureEncoding> encoding;  ///< of every plane
  std::vector<std::byte> codes;
};

}  // namespace facezip::test
