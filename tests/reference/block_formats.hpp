// Reference decoders of BC1, BC4 and BC7 blocks, written from the Khronos Data Format Specification 1.3 (chapters S3TC,
// RGTC and BPTC): a block as a string of bits, every mode as the row of the specification's table, weights as it lists
// them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace facezip::reference {

/// [texel][red, green, blue, alpha], 0 to 255, not rounded.
using BlockTexels = std::array<std::array<double, 4>, 16>;

// Subsets of the 64 partitions, texel by texel; letters mark the texels whose index has one bit less.
inline constexpr std::array<std::string_view, 64> kTwoSubsets = {
    "A01100110011001B", "A00100010001000B", "A11101110111011B", "A00100110011011B", "A00000010001001B",
    "A01101110111111B", "A00100110111111B", "A00000010011011B", "A00000000001001B", "A01101111111111B",
    "A00000010111111B", "A00000000001011B", "A00101111111111B", "A00000001111111B", "A00011111111111B",
    "A00000000000111B", "A00010001110111B", "A1B1000100000000", "A0000000B0001110", "A1B1001100010000",
    "A0B1000100000000", "A0001000B1001110", "A0000000B0001100", "A11100110011000B", "A0B1000100010000",
    "A0001000B0001100", "A1B0011001100110", "A0B1011001101100", "A0010111B1101000", "A0001111B1110000",
    "A1B1000110001110", "A0B1100110011100", "A10101010101010B", "A00011110000111B", "A10110B001011010",
    "A0110011B1001100", "A0B1110000111100", "A1010101B0101010", "A11010010110100B", "A10110101010010B",
    "A1B1001111001110", "A0010011B1001000", "A0B1001001001100", "A0B1101111011100", "A1B0100110010110",
    "A01111001100001B", "A11001101001100B", "A00001B001100000", "A10011B001000000", "A0B0011100100000",
    "A00000B001110010", "A0000100B1100100", "A11011001001001B", "A01101101100100B", "A1B0001110011100",
    "A0B1100111000110", "A11011001100100B", "A11000110011100B", "A11111101000000B", "A00110001110011B",
    "A00011110011001B", "A0B1001111110000", "A0B0001011101110", "A10001000111011B",
};
inline constexpr std::array<std::string_view, 64> kThreeSubsets = {
    "A01B00110221222C", "A00B0011C2112221", "A0002001C211221B", "A22C00220011011B", "A0000000B122112C",
    "A01B00110022002C", "A02C00221111111B", "A0110011C211221B", "A0000000B111222C", "A0001111B111222C",
    "A00011B12222222C", "A01200B20012001C", "A11201B20112011C", "A1220B220122012C", "A01B01121122122C",
    "A01B2001C2002220", "A00B00110112112C", "A11B0011C0012200", "A0001122B122112C", "A02C00220022111B",
    "A11B01110222022C", "A00B0001C2212221", "A00000B10122012C", "A0001100C2B02210", "A12C0B2200110000",
    "A0120012B122222C", "A11012C1B2210110", "A00001B012C11221", "A0221102B102002C", "A1100B102002222C",
    "A011012201C2001B", "A0002000C211222B", "A0000002B122122C", "A22C00220012001B", "A01B00120022022C",
    "A1200B2001C00120", "A00011B122C20000", "A1201201C0B20120", "A1202012BC010120", "A011220011C2001B",
    "A01111C22200001B", "A10B01012222222C", "A0000000C121212B", "A0221B220022112C", "A02C00110022001B",
    "A22012C10220122B", "A10122C22222010B", "A0002121C121212B", "A10B01010101222C", "A22C01110222011B",
    "A0021B120002111C", "A0002B122112211C", "A2220B110111022C", "A0021112B112000C", "A1100B100110222C",
    "A000000021B2211C", "A1100B102222222C", "A022001100B1002C", "A0221122B122002C", "A000000000002B1C",
    "A00C00010002000B", "A22212220222B22C", "A10B22222222222C", "A11B2011C2012220",
};

/// The bits of a block, the first one first.
inline std::string bitString(const std::uint8_t* block, std::size_t bytes) {
  std::string bits;
  for (std::size_t i = 0; i < 8 * bytes; ++i) bits += (block[i / 8] >> (i % 8)) % 2 == 1 ? '1' : '0';
  return bits;
}

/// Removes the first `count` bits and returns their value; the first one is the lowest.
inline int takeBits(std::string& bits, int count) {
  int value = 0;
  for (int i = 0; i < count; ++i) value += bits[static_cast<std::size_t>(i)] == '1' ? 1 << i : 0;
  bits.erase(0, static_cast<std::size_t>(count));
  return value;
}

struct Bc7Mode {
  int subsets, partition_bits, rotation_bits, selector_bits, colour_bits, alpha_bits;
  int end_p_bits, shared_p_bits, index_bits, second_index_bits;
};
inline constexpr std::array<Bc7Mode, 8> kBc7Modes = {{{3, 4, 0, 0, 4, 0, 1, 0, 3, 0},
                                                      {2, 6, 0, 0, 6, 0, 0, 1, 3, 0},
                                                      {3, 6, 0, 0, 5, 0, 0, 0, 2, 0},
                                                      {2, 6, 0, 0, 7, 0, 1, 0, 2, 0},
                                                      {1, 0, 2, 1, 5, 6, 0, 0, 2, 3},
                                                      {1, 0, 2, 0, 7, 8, 0, 0, 2, 2},
                                                      {1, 0, 0, 0, 7, 7, 1, 0, 4, 0},
                                                      {2, 6, 0, 0, 5, 5, 1, 0, 2, 0}}};

/// A value between two ends, by the weights that the specification lists.
inline int bc7Between(int a, int b, int index, int bits) {
  static const std::vector<std::vector<int>> weights = {{},
                                                        {},
                                                        {0, 21, 43, 64},
                                                        {0, 9, 18, 27, 37, 46, 55, 64},
                                                        {0, 4, 9, 13, 17, 21, 26, 30, 34, 38, 43, 47, 51, 55, 60, 64}};
  const int weight = weights[static_cast<std::size_t>(bits)][static_cast<std::size_t>(index)];
  return ((64 - weight) * a + weight * b + 32) / 64;
}

inline int bc7Mode(const std::uint8_t* block) { return static_cast<int>(bitString(block, 16).find('1')); }

inline BlockTexels decodeBc7(const std::uint8_t* block) {
  BlockTexels texels{};
  std::string bits = bitString(block, 16);
  const std::size_t mode_number = bits.find('1');
  if (mode_number >= 8) return texels;
  const Bc7Mode& mode = kBc7Modes[mode_number];
  bits.erase(0, mode_number + 1);
  const auto partition = static_cast<std::size_t>(takeBits(bits, mode.partition_bits));
  const int rotation = takeBits(bits, mode.rotation_bits);
  const int selector = takeBits(bits, mode.selector_bits);
  int ends[4][6] = {};
  for (int c = 0; c < 4; ++c) {
    for (int i = 0; i < 2 * mode.subsets; ++i) ends[c][i] = takeBits(bits, c < 3 ? mode.colour_bits : mode.alpha_bits);
  }
  int p_bits[6] = {};
  for (int i = 0; i < 2 * mode.subsets; ++i) {
    if (mode.end_p_bits == 1) p_bits[i] = takeBits(bits, 1);
    if (mode.shared_p_bits == 1) p_bits[i] = i % 2 == 0 ? takeBits(bits, 1) : p_bits[i - 1];
  }
  for (int c = 0; c < 4; ++c) {
    for (int i = 0; i < 2 * mode.subsets; ++i) {
      int count = c < 3 ? mode.colour_bits : mode.alpha_bits;
      if (count == 0) {
        ends[c][i] = 255;
        continue;
      }
      if (mode.end_p_bits + mode.shared_p_bits > 0) {
        ends[c][i] = 2 * ends[c][i] + p_bits[i];
        ++count;
      }
      // The upper bits once more below, as many as there is room for.
      std::string digits;
      for (int b = count - 1; b >= 0; --b) digits += (ends[c][i] >> b) % 2 == 1 ? '1' : '0';
      digits = (digits + digits).substr(0, 8);
      ends[c][i] = std::stoi(digits, nullptr, 2);
    }
  }
  const std::string_view subsets = mode.subsets == 2   ? kTwoSubsets[partition]
                                   : mode.subsets == 3 ? kThreeSubsets[partition]
                                                       : std::string_view("A000000000000000");
  int index[2][16] = {};
  for (std::size_t t = 0; t < 16; ++t) index[0][t] = takeBits(bits, mode.index_bits - (subsets[t] >= 'A' ? 1 : 0));
  if (mode.second_index_bits > 0) {
    for (std::size_t t = 0; t < 16; ++t) index[1][t] = takeBits(bits, mode.second_index_bits - (t == 0 ? 1 : 0));
  }
  for (std::size_t t = 0; t < 16; ++t) {
    const int subset = subsets[t] >= 'A' ? subsets[t] - 'A' : subsets[t] - '0';
    const int colour_set = selector;
    const int alpha_set = mode.second_index_bits > 0 ? 1 - selector : 0;
    int value[4];
    for (int c = 0; c < 4; ++c) {
      const int set = c < 3 ? colour_set : alpha_set;
      value[c] = bc7Between(ends[c][2 * subset], ends[c][2 * subset + 1], index[set][t],
                            set == 0 ? mode.index_bits : mode.second_index_bits);
    }
    if (rotation == 1) std::swap(value[3], value[0]);
    if (rotation == 2) std::swap(value[3], value[1]);
    if (rotation == 3) std::swap(value[3], value[2]);
    for (std::size_t c = 0; c < 4; ++c) texels[t][c] = value[c];
  }
  return texels;
}

/// Code of texel t of a BC1 block: with three colours 3 is transparent.
inline int bc1Code(const std::uint8_t* block, int t) { return block[4 + t / 4] >> (2 * (t % 4)) & 3; }
inline bool bc1HasFourColours(const std::uint8_t* block) {
  return block[0] + 256 * block[1] > block[2] + 256 * block[3];
}

inline BlockTexels decodeBc1(const std::uint8_t* block) {
  std::array<std::array<double, 4>, 4> colours{};
  for (std::size_t i = 0; i < 2; ++i) {
    std::string bits = bitString(block + 2 * i, 2);
    const int blue = takeBits(bits, 5);
    const int green = takeBits(bits, 6);
    const int red = takeBits(bits, 5);
    colours[i] = {red * 8.0 + red / 4, green * 4.0 + green / 16, blue * 8.0 + blue / 4, 255.0};
  }
  for (std::size_t c = 0; c < 4; ++c) {
    const double a = colours[0][c];
    const double b = colours[1][c];
    colours[2][c] = bc1HasFourColours(block) ? (2.0 * a + b) / 3.0 : (a + b) / 2.0;
    colours[3][c] = bc1HasFourColours(block) ? (a + 2.0 * b) / 3.0 : 0.0;
  }
  BlockTexels texels;
  for (int t = 0; t < 16; ++t)
    texels[static_cast<std::size_t>(t)] = colours[static_cast<std::size_t>(bc1Code(block, t))];
  return texels;
}

inline std::array<double, 16> decodeBc4(const std::uint8_t* block) {
  const double a = block[0];
  const double b = block[1];
  const std::vector<double> values =
      block[0] > block[1]
          ? std::vector<double>{a,
                                b,
                                (6 * a + b) / 7,
                                (5 * a + 2 * b) / 7,
                                (4 * a + 3 * b) / 7,
                                (3 * a + 4 * b) / 7,
                                (2 * a + 5 * b) / 7,
                                (a + 6 * b) / 7}
          : std::vector<double>{a,   b,    (4 * a + b) / 5, (3 * a + 2 * b) / 5, (2 * a + 3 * b) / 5, (a + 4 * b) / 5,
                                0.0, 255.0};
  std::string bits = bitString(block + 2, 6);
  std::array<double, 16> texels;
  for (double& texel : texels) texel = values[static_cast<std::size_t>(takeBits(bits, 3))];
  return texels;
}

}  // namespace facezip::reference
