#include "blocks/texel_layout.hpp"

#include "blocks/block_format.hpp"

namespace facezip::blocks {

std::size_t TexelLayout::end(int channels) const {
  const auto lastOf = [](int count) { return static_cast<std::size_t>(count - 1); };
  const std::size_t across = lastOf(channels) * channel_stride + 1;
  if (tiled()) return tile_count == 0 ? 0 : first + (tile_count - 1) * row_stride + (kTileTexels - 1) + across;
  if (width == 0 || rows == 0) return 0;
  return first + lastOf(rows) * row_stride + lastOf(width) * texel_stride + across;
}

TexelLayout TexelLayout::interleaved(int width, int rows, int channels) {
  return {.width = width,
          .rows = rows,
          .texel_stride = static_cast<std::size_t>(channels),
          .channel_stride = 1,
          .row_stride = static_cast<std::size_t>(width) * static_cast<std::size_t>(channels)};
}

TexelLayout TexelLayout::planar(int width, int rows) {
  return {.width = width,
          .rows = rows,
          .texel_stride = 1,
          .channel_stride = static_cast<std::size_t>(width) * static_cast<std::size_t>(rows),
          .row_stride = static_cast<std::size_t>(width)};
}

TexelLayout TexelLayout::inTiles(int width, int rows, int channels, const cl::Buffer& tiles, std::size_t tile_count,
                                 int textures, int texture) {
  const auto plane = static_cast<std::size_t>(channels) * kTileTexels;
  return {.width = width,
          .rows = rows,
          .first = static_cast<std::size_t>(texture) * plane,
          .texel_stride = 1,
          .channel_stride = kTileTexels,
          .row_stride = static_cast<std::size_t>(textures) * plane,
          .tiles = tiles,
          .tile_count = tile_count};
}

KernelLayout kernelLayout(const TexelLayout& layout) {
  const int blocks_x = blockCount(layout.width, 4);
  const int blocks_y = blockCount(layout.rows, 4);
  const std::size_t in_rows = static_cast<std::size_t>(blocks_x) * static_cast<std::size_t>(blocks_y);
  return {.width = layout.width,
          .rows = layout.rows,
          .blocks_x = blocks_x,
          .blocks_y = blocks_y,
          .texel_stride = layout.texel_stride,
          .channel_stride = layout.channel_stride,
          .row_stride = layout.row_stride,
          .first = layout.first,
          .blocks = layout.tiled() ? layout.tile_count * (kTileTexels / 16) : in_rows};
}

}  // namespace facezip::blocks
