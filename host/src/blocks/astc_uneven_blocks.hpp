// astc_uneven_blocks.hpp - blocks whose texels differ in weight, for an encoder that has no weights of texels.
// A texel of weight w asks for w times what it is, and for the rest for what it may be: minimising |w x + (1 - w) f -
// d|^2 over d, with f what the block decoded to before, never raises the sum of w |x - d|^2 (majorisation).
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "blocks/astc_codec.hpp"
#include "blocks/block_format.hpp"

namespace facezip::blocks {

class UnevenBlocks {
 public:
  /// weights  rows x width; empty: there are no such blocks
  /// rgba     rows x width x 4, what is asked for
  UnevenBlocks(BlockFormat format, int width, int rows, std::span<const float> weights, std::span<const float> rgba);

  /// What to begin with: texels without weight go on from those around them.
  void fillGaps(std::span<float> rgba) const;

  /// f is what `blocks` decode to; blocks that get better are replaced.
  /// channel_weights  0 for channels that are not stored
  void improve(AstcCodec& codec, const std::array<float, 4>& channel_weights, std::span<std::byte> blocks) const;

 private:
  /// A block beside the others in a strip of them: position in the picture, size without what hangs over.
  struct Block {
    std::size_t index;
    int x, y, columns, rows;
  };
  void fillGaps(std::size_t block, std::span<std::array<float, 4>> texels) const;
  std::size_t stripTexel(std::size_t block, int column, int row) const;
  double error(std::size_t block, const std::array<float, 4>& channel_weights, std::span<const float> decoded) const;

  BlockFormat format_;
  int width_;
  std::vector<Block> blocks_;
  // As a picture of one row of blocks: texels that are asked for, and weights as shares of the block's largest.
  std::vector<float> wanted_;
  std::vector<float> weights_;
};

}  // namespace facezip::blocks
