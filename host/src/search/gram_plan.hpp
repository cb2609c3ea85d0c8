// gram_plan.hpp - which sums each tile of a band takes part in, and where the partial sums of the Gram kernels lie.
#pragma once

#include <cstddef>
#include <vector>

#include "bands/device_tiles.hpp"
#include "io/counts.hpp"
#include "search/gram_matrices.hpp"

namespace facezip::compress {

/// Tiles of a run are added in float32 on the device: few enough that the rounding stays near that of one tile.
inline constexpr std::size_t kTilesPerRun = 64;
/// A run also ends when its tiles take part in this many sums: runs cost alike, and the loops of a work-item stay
/// within the 65,535 rounds that llvmpipe grants it (gram_gpu.cl: about 200 rounds per 32 sums of a tile).
inline constexpr std::size_t kSumsPerRun = 2048;

/// The work of one launch over the tiles [first_tile, first_tile + tile_count) of a band, cut into runs of
/// kTilesPerRun. Indices of tiles are those of the band. Each run has one row of partial sums per slot that its tiles
/// take part in.
struct GramPlan {
  std::size_t first_tile = 0;
  std::size_t tile_count = 0;
  std::vector<cl_int> run_begin;   ///< #runs + 1, tiles
  std::vector<cl_int> run_rows;    ///< #runs + 1, rows of partial sums
  std::vector<cl_int> slot_begin;  ///< #tiles of the band + 1, entries of `entries`; only those of the launch are set
  std::vector<cl_int2>
      entries;               ///< {row, (a + 1) | (b + 1) << 16} with masks a < b counted inside the tile, 0 for none
  std::vector<int> touched;  ///< slots with a row or more, rising
  std::vector<cl_int> touched_begin;  ///< #touched + 1, entries of touched_rows
  std::vector<cl_int> touched_rows;   ///< the rows of a slot in rising run order

  std::size_t runs() const { return run_begin.size() - 1; }
  std::size_t rows() const { return toSize(run_rows.back()); }
};

/// Finds the slot of a pair of masks in constant time.
class PairSlots {
 public:
  explicit PairSlots(const GramSlots& slots);
  /// Slot of masks k < l, or -1 if the pair is not listed.
  int operator()(int k, int l) const { return slot_[Layout(masks_, masks_)(k, l)]; }

 private:
  int masks_;
  std::vector<int> slot_;  ///< K x K
};

/// Plans the tiles from `first_tile` on: as many runs as keep the number of rows within `most_rows`, at least one.
GramPlan planGram(const DeviceTiles& tiles, const GramSlots& slots, const PairSlots& pair_slots, std::size_t first_tile,
                  std::size_t most_rows);

}  // namespace facezip::compress
