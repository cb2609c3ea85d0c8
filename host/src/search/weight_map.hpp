// weight_map.hpp - the weights with which every expression mixes the difference textures (FaceZip Eq. 6).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "device/device_context.hpp"
#include "device/pooled_buffer.hpp"
#include "raster/grid_masks.hpp"

namespace facezip::compress {

using raster::CellMasks;

/// Fills weight maps, a range of cells at a time, so that a caller can stream them in bands. Keeps its device buffers
/// from one call to the next. Not for use by two threads at once.
class WeightMapper {
 public:
  /// texture_of   K x N, each in [0, C): textureOfExpression()
  /// clusters     C, 1 to 8
  WeightMapper(device::DeviceContext& context, std::span<const int> texture_of, int masks, int expressions,
               int clusters);

  /// Bytes of fill()'s output for `cell_count` cells.
  std::size_t outputBytes(std::size_t cell_count) const;

  /// W_in = sum_k alpha_ink M_k of cells first_cell .. first_cell + cell_count - 1 (Eq. 6), as bytes
  /// [expression][cell][C] that stand for byte / 255: 255 w + 1/2 rounded down, at most 255.
  /// out   outputBytes(cell_count) bytes
  /// Throws DeviceError, also when the range is too large for the device.
  void fill(const CellMasks& cells, std::size_t first_cell, std::size_t cell_count, std::span<std::uint8_t> out);

  /// The same of all cells, a range at a time: device memory does not grow with the grid.
  void fillAll(const CellMasks& cells, std::span<std::uint8_t> out);

 private:
  device::DeviceContext& context_;
  int expressions_;
  int clusters_;
  cl::Buffer texture_of_;
  device::PooledBuffer cell_begin_;
  device::PooledBuffer mask_index_;
  device::PooledBuffer mask_weights_;
  device::PooledBuffer weights_;
};

/// Sizes and device buffers of one launch of kernels/cl/weight_map.cl, which describes them.
struct WeightMapLaunch {
  std::size_t cells = 0;
  int expressions = 0;
  int clusters = 0;
  int first_entry = 0;  ///< what cell_begin counts from
  cl::Buffer cell_begin;
  cl::Buffer mask_index;
  cl::Buffer mask_weights;
  cl::Buffer texture_of;
  cl::Buffer weights;
};

/// Enqueues the kernel; the caller owns the buffers. For tests and benchmarks.
cl::Event launchWeightMap(device::DeviceContext& context, const WeightMapLaunch& launch);

/// K x padded N in the layout of the kernel's buffer `texture_of`.
std::vector<int> packTextureOf(std::span<const int> texture_of, int masks, int expressions);

}  // namespace facezip::compress
