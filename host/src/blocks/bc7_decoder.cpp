#include <bit>

#include "blocks/bc_decoder.hpp"

namespace facezip::blocks {
namespace {

// The tables that kernels use, in their language.
using uchar = std::uint8_t;
using ushort = std::uint16_t;
using uint = std::uint32_t;
#define constant constexpr
#include "cl/bc7_tables.h"
#undef constant

/// Takes bits from the lowest up.
class BitReader {
 public:
  explicit BitReader(std::span<const std::byte, 16> block) {
    for (std::size_t i = 0; i < 8; ++i) {
      low_ |= std::to_integer<std::uint64_t>(block[i]) << (8 * i);
      high_ |= std::to_integer<std::uint64_t>(block[i + 8]) << (8 * i);
    }
  }

  unsigned take(unsigned count) {
    const auto value = static_cast<unsigned>(low_ & ((1u << count) - 1));
    if (count > 0) {
      low_ = low_ >> count | high_ << (64 - count);
      high_ >>= count;
    }
    return value;
  }

 private:
  std::uint64_t low_ = 0;
  std::uint64_t high_ = 0;
};

using Ends = std::array<std::array<unsigned, 4>, 6>;  // two a subset

/// `bits` bits as 8, the upper ones repeated below.
unsigned widened(unsigned value, unsigned bits) {
  value <<= 8 - bits;
  return value | value >> bits;
}

Ends takeEnds(BitReader& bits, std::size_t mode) {
  Ends ends{};
  const std::size_t count = 2 * static_cast<std::size_t>(kSubsets[mode]);
  for (std::size_t c = 0; c < 4; ++c) {
    for (std::size_t i = 0; i < count; ++i) ends[i][c] = bits.take(c < 3 ? kColourBits[mode] : kAlphaBits[mode]);
  }
  const bool has_p = kPBits[mode] > 0;
  unsigned p = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (has_p && (kPBits[mode] == 2 || i % 2 == 0)) p = bits.take(1);
    for (std::size_t c = 0; c < 4; ++c) {
      const unsigned own_bits = c < 3 ? kColourBits[mode] : kAlphaBits[mode];
      const unsigned code = has_p ? ends[i][c] << 1 | p : ends[i][c];
      ends[i][c] = own_bits == 0 ? 255 : widened(code, own_bits + (has_p ? 1 : 0));
    }
  }
  return ends;
}

/// The first texel of every subset has an index of one bit less.
bool isAnchor(std::size_t mode, unsigned partition, unsigned t) {
  if (t == 0) return true;
  if (kSubsets[mode] == 2) return t == kSecondAnchor[partition];
  return kSubsets[mode] == 3 && (t == (kThreeAnchors[partition] & 15u) || t == kThreeAnchors[partition] >> 4);
}

unsigned subsetOf(std::size_t mode, unsigned partition, unsigned t) {
  if (kSubsets[mode] == 1) return 0;
  return kSubsets[mode] == 2 ? kTwoSubsets[partition] >> t & 1u : kThreeSubsets[partition] >> (2 * t) & 3u;
}

std::uint8_t interpolate(unsigned a, unsigned b, unsigned index, unsigned bits) {
  const unsigned last = (1u << bits) - 1;
  const unsigned weight = (128 * index + last) / (2 * last);  // index / last in 64ths
  return static_cast<std::uint8_t>(((64 - weight) * a + weight * b + 32) >> 6);
}

}  // namespace

BlockColours decodeBc7(std::span<const std::byte, 16> block) {
  BlockColours colours{};
  const auto mode = static_cast<std::size_t>(std::countr_zero(std::to_integer<unsigned>(block[0]) | 256u));
  if (mode == 8) return colours;
  BitReader bits(block);
  bits.take(static_cast<unsigned>(mode) + 1);
  const unsigned partition = bits.take(kPartitionBits[mode]);
  const unsigned second_bits = kSecondIndexBits[mode];
  const unsigned rotation = second_bits > 0 ? bits.take(2) : 0;
  const unsigned selector = mode == 4 ? bits.take(1) : 0;
  const Ends ends = takeEnds(bits, mode);
  std::array<unsigned, 16> first{};
  std::array<unsigned, 16> second{};
  for (unsigned t = 0; t < 16; ++t) first[t] = bits.take(kIndexBits[mode] - (isAnchor(mode, partition, t) ? 1u : 0u));
  for (unsigned t = 0; t < 16 && second_bits > 0; ++t) second[t] = bits.take(second_bits - (t == 0 ? 1u : 0u));
  for (unsigned t = 0; t < 16; ++t) {
    const std::size_t subset = subsetOf(mode, partition, t);
    for (std::size_t c = 0; c < 4; ++c) {
      // Where alpha has a plane of its own, the selector says whose indices come second.
      const bool other = second_bits > 0 && (c == 3) == (selector == 0);
      colours[t][c] = interpolate(ends[2 * subset][c], ends[2 * subset + 1][c], other ? second[t] : first[t],
                                  other ? second_bits : kIndexBits[mode]);
    }
    if (rotation > 0) std::swap(colours[t][3], colours[t][rotation - 1]);
  }
  return colours;
}

}  // namespace facezip::blocks
