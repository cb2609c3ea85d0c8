// gram.hpp - weighted Gram matrices of the differences, accumulated band by band.
//   G_s[n, m] = sum over covered texels p of w_s(p) * sum over channels of Delta_n(p) . Delta_m(p)
// with w = 1, M_k^2 (fragments, Eq. 2) or (M_k M_l)^2 (seams, Eq. 3 and 4), times a weight per map.
#pragma once

#include <cstddef>
#include <vector>

#include "bands/device_tiles.hpp"
#include "bands/tile_band.hpp"
#include "device/device_context.hpp"
#include "device/pooled_buffer.hpp"
#include "search/gram_matrices.hpp"
#include "search/gram_plan.hpp"

namespace facezip::compress {

/// Adds up the Gram matrices of a capture, map by map and band by band.
///
/// Sums: texels of a tile in float32, tiles of a run (at most 64) in float32, runs by compensated sums on the device,
/// bands in double on the host; every order is fixed, so the bits are the same on every run of one device. Expressions
/// with equal samples get equal rows to the last bit.
/// Memory on the device: the partial sums of a launch stay below `largest_partial_bytes`, and above it only if one run
/// of tiles under one block of 4 x 4 expressions needs more; a band that needs more is done in several launches.
class GramAccumulator {
 public:
  static constexpr std::size_t kLargestPartialBytes = std::size_t{64} << 20;

  /// slots        the matrices that are wanted. A pair of masks that a tile holds but `slots` does not list is taken
  ///              to share no texel and is left out.
  /// expressions  N, 1 or more
  /// variant      register-blocked work-items (kCpu) or work-groups with local memory (kGpu)
  GramAccumulator(device::DeviceContext& context, GramSlots slots, int expressions,
                  device::KernelVariant variant = device::KernelVariant::kAuto,
                  std::size_t largest_partial_bytes = kLargestPartialBytes);

  /// Adds one band of one map. Waits for the device.
  /// differences    what computeDifferences() wrote for the same tiles and shape; shape.expressions is N
  /// metric_weight  factor of this map, 0 or more
  /// Throws DeviceError if `differences` is too small or the device fails.
  void add(const DeviceTiles& tiles, const cl::Buffer& differences, const BandShape& shape, double metric_weight);

  /// Returns the sums so far and starts again from zero.
  GramMatrices finish();

 private:
  void holdSums();
  void uploadPlan(const GramPlan& plan);
  cl::Event runBlocks(const DeviceTiles& tiles, const cl::Buffer& differences, const BandShape& shape,
                      const GramPlan& plan, int first_block, int block_count);
  void addSums(const GramPlan& plan, int first_block, int block_count, double metric_weight);

  device::DeviceContext& context_;
  device::KernelVariant variant_;
  std::size_t largest_partial_bytes_;
  PairSlots pair_slots_;
  GramMatrices sums_;
  device::PooledBuffer run_begin_;
  device::PooledBuffer run_rows_;
  device::PooledBuffer slot_begin_;
  device::PooledBuffer entries_;
  device::PooledBuffer touched_begin_;
  device::PooledBuffer touched_rows_;
  device::PooledBuffer partial_;
  device::PooledBuffer reduced_;
};

}  // namespace facezip::compress
