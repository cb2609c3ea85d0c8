// texel_layout.hpp - where the texels of a picture lie in a buffer of the device; kernels/cl/block_texels.h has the
// same.
#pragma once

#include <cstddef>

#include "device/device_context.hpp"

namespace facezip::blocks {

/// Sides of tiles.h's tiles.
inline constexpr int kTileSide = 16;
inline constexpr int kTileTexels = kTileSide * kTileSide;

/// Strides count samples.
struct TexelLayout {
  int width = 0;
  int rows = 0;
  std::size_t first = 0;  ///< of the texel in the corner
  std::size_t texel_stride = 0;
  std::size_t channel_stride = 0;
  std::size_t row_stride = 0;  ///< from row to row, or from tile to tile
  /// Tiles: [tile] int2, column and row of tiles in the picture; a null buffer where texels lie in rows.
  cl::Buffer tiles = {};
  std::size_t tile_count = 0;

  bool tiled() const { return tiles() != nullptr; }
  /// One past the last sample of `channels` channels that is read or written.
  std::size_t end(int channels) const;

  /// rows x width x channels.
  static TexelLayout interleaved(int width, int rows, int channels);
  /// channels x rows x width.
  static TexelLayout planar(int width, int rows);
  /// [tile][texture][channel][256], of which it is texture `texture`: difference textures as kernels fit them. Tiles
  /// may hang over the right and the bottom edge. Blocks of tiles that are not listed are left alone.
  static TexelLayout inTiles(int width, int rows, int channels, const cl::Buffer& tiles, std::size_t tile_count,
                             int textures, int texture);
};

/// Layout of block_texels.h for blocks of 4 x 4 texels.
struct KernelLayout {
  using KernelStruct = void;
  cl_int width, rows;
  cl_int blocks_x, blocks_y;
  cl_ulong texel_stride, channel_stride, row_stride;
  cl_ulong first;
  cl_ulong blocks;  ///< to visit
};
KernelLayout kernelLayout(const TexelLayout& layout);

}  // namespace facezip::blocks
