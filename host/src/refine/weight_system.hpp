// weight_system.hpp - the least squares problem of the grid weights under given difference textures, and its solution.
//   minimise  sum_p t(p) |Delta_n(p) - D(p)^T w_n(p)|^2 + smoothness sum_{q ~ q'} |W_n(q) - W_n(q')|^2
//             + trust sum_q |W_n(q) - start_n(q)|^2           for every expression n; q ~ q' are the grid's edges
// The matrix is the same for all n. Its condition is that of a bilinear mass matrix (9) times that of the C x C blocks,
// which block Gauss-Seidel divides out: three sweeps in four colours bring what a factorisation would within a per
// cent, need no reduction, and lower the objective at every step.
#pragma once

#include "device/device_context.hpp"
#include "device/pooled_buffer.hpp"
#include "refine/grid_band.hpp"
#include "refine/half_cells.hpp"
#include "refine/weight_window.hpp"

namespace facezip::compress {

class WeightSystem {
 public:
  /// variant  register-blocked sums over a tile (kCpu) or one work-item per number (kGpu)
  WeightSystem(device::DeviceContext& context, const WeightSpace& space,
               device::KernelVariant variant = device::KernelVariant::kAuto);

  /// Starts the equations of a window's rows from nothing.
  void clear() { empty_ = true; }

  /// Adds a band of one map. Does not wait.
  /// tile_at   index of the band's tile at [tile row][tile column], -1 where there is none; see tileLookup()
  /// textures  D of the band, as DifferenceFit leaves it
  void add(const GridBand& band, const cl::Buffer& tile_at, const cl::Buffer& textures, const WeightWindow& window,
           double metric_weight);

  /// Takes the equations of the window's free rows from half cells, instead of adding bands. Does not wait.
  void gather(const HalfCells& halves, const WeightWindow& window);

  /// The two steps of add(), for benchmarks: the sums of every tile, and what they add to the cells.
  void sumTiles(const GridBand& band, const cl::Buffer& textures);
  void gather(const GridBand& band, const cl::Buffer& tile_at, const WeightWindow& window, double metric_weight);

  /// Moves the free weights of the window towards the minimum, `sweeps` times over all of them. Does not wait.
  /// smoothness, trust  above 0
  void relax(const WeightWindow& window, int sweeps, float smoothness, float trust);

  /// [tile][patch of cells][entries], what sumTiles() left, for tests; layout in kernels/cl/weight_system.cl.
  const cl::Buffer& tileSums() const { return partial_.buffer(); }
  /// [held rows][columns][entries], for tests.
  const cl::Buffer& equations() const { return system_.buffer(); }

 private:
  void reserve(const WeightWindow& window);

  device::DeviceContext& context_;
  WeightSpace space_;
  bool gpu_;
  bool empty_ = true;
  device::PooledBuffer partial_;
  device::PooledBuffer system_;
};

/// Bytes of partial sums that `add` keeps for a tile.
std::size_t systemBytesOfTile(const WeightSpace& space, int weight_scale);

}  // namespace facezip::compress
