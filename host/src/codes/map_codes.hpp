// map_codes.hpp - the codes that hold the difference textures of a map: their bits, scales and offsets.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "facezip/block_format.hpp"
#include "refine/grid_weights.hpp"
#include "refine/texture_encoding.hpp"

namespace facezip::compress {

struct MapCodes {
  int bits = 8;                           ///< of a code, 8 or 16
  std::vector<TextureEncoding> encoding;  ///< C x channels
  std::vector<BlockFormat> formats = {};  ///< C; empty: images
};

/// Codes of `bits` bits for textures that reach so far, C x channels.
MapCodes codesOfBits(std::span<const TextureRange> ranges, int bits);

/// Codes of difference textures in blocks of one format. Zero is a code that blocks of one colour decode to exactly, as
/// far as the format has such: what does not differ stays as it is. formats.size() is C.
MapCodes codesOfBlocks(std::span<const TextureRange> ranges, BlockFormat format, int textures);

/// Mean of W^2 of each weight channel over the cells that `used` marks and all expressions, as decoded; C values.
std::vector<double> meanSquares(const EncodedWeights& weights, const WeightSpace& space,
                                std::span<const std::uint8_t> used);

/// Squared error that rounding difference textures to 8 bits adds to one texel of one expression, summed over channels:
/// a step's variance is its square / 12, and texture i counts with the mean square of its weights.
/// ranges          C x channels
/// weight_squares  C
double codeSquaredError(std::span<const TextureRange> ranges, std::span<const double> weight_squares);

/// Of a map whose samples have more than 8 bits: 16 where 8-bit codes would add more than a twentieth to the squared
/// error (2.5 % to the RMSE), else 8.
int codeBits(double code_error, double error);

}  // namespace facezip::compress
