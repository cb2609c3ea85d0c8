#include "search/gram_plan.hpp"

#include <algorithm>
#include <cassert>
#include <span>

#include "io/counts.hpp"

namespace facezip::compress {
namespace {

/// Masks a and b of a tile, as the kernels read them; -1 for none.
cl_int packMasks(int a, int b) { return (a + 1) | (b + 1) << 16; }

/// Appends the entries of one tile with the slot in place of the row: whole, masks, pairs.
void appendTile(std::span<const int> masks, const GramSlots& slots, const PairSlots& pair_slots,
                std::vector<cl_int2>& entries) {
  const auto append = [&entries](int slot, int a, int b) { entries.push_back({{slot, packMasks(a, b)}}); };
  const int count = static_cast<int>(masks.size());
  assert(count < 0x7fff);
  append(slots.whole(), -1, -1);
  for (int a = 0; a < count; ++a) append(slots.mask(masks[toSize(a)]), a, -1);
  for (int a = 0; a < count; ++a) {
    for (int b = a + 1; b < count; ++b) {
      const int slot = pair_slots(masks[toSize(a)], masks[toSize(b)]);
      if (slot >= 0) append(slot, a, b);
    }
  }
}

/// Appends the tiles of one run, with slots in place of rows. Returns the tile behind it.
std::size_t appendRun(const DeviceTiles& tiles, const GramSlots& slots, const PairSlots& pair_slots, std::size_t tile,
                      GramPlan& plan) {
  const std::size_t last = std::min(tile + kTilesPerRun, tiles.tileCount());
  const std::size_t first_entry = plan.entries.size();
  while (tile < last && plan.entries.size() - first_entry < kSumsPerRun) {
    plan.slot_begin[tile] = static_cast<cl_int>(plan.entries.size());
    appendTile(tiles.masksOf(tile), slots, pair_slots, plan.entries);
    plan.slot_begin[++tile] = static_cast<cl_int>(plan.entries.size());
  }
  return tile;
}

/// Gives every slot of a run a row and replaces slots by rows. `row_of_slot` is -1 throughout, before and after.
/// Returns the slots of the run, rising, in the order of their rows.
std::vector<int> numberRows(std::span<cl_int2> entries, int first_row, std::vector<int>& row_of_slot) {
  std::vector<int> used;
  for (const cl_int2& entry : entries) {
    int& row = row_of_slot[toSize(entry.s[0])];
    if (row < 0) used.push_back(entry.s[0]);
    row = 0;
  }
  std::sort(used.begin(), used.end());
  for (std::size_t i = 0; i < used.size(); ++i) {
    row_of_slot[toSize(used[i])] = first_row + static_cast<int>(i);
  }
  for (cl_int2& entry : entries) entry.s[0] = row_of_slot[toSize(entry.s[0])];
  for (const int slot : used) row_of_slot[toSize(slot)] = -1;
  return used;
}

/// Inverts run -> slots into slot -> rows.
void listRows(const std::vector<std::vector<int>>& run_slots, int slot_count, GramPlan& plan) {
  std::vector<std::vector<cl_int>> rows(toSize(slot_count));
  cl_int row = 0;
  for (const std::vector<int>& run : run_slots) {
    for (const int slot : run) rows[toSize(slot)].push_back(row++);
  }
  plan.touched_begin.push_back(0);
  for (std::size_t slot = 0; slot < rows.size(); ++slot) {
    if (rows[slot].empty()) continue;
    plan.touched.push_back(static_cast<int>(slot));
    plan.touched_rows.insert(plan.touched_rows.end(), rows[slot].begin(), rows[slot].end());
    plan.touched_begin.push_back(static_cast<cl_int>(plan.touched_rows.size()));
  }
}

}  // namespace

PairSlots::PairSlots(const GramSlots& slots) : masks_(slots.masks), slot_(toSize(slots.masks, slots.masks), -1) {
  for (std::size_t j = 0; j < slots.pairs.size(); ++j) {
    const auto [k, l] = slots.pairs[j];
    assert(0 <= k && k < l && l < masks_);
    slot_[Layout(masks_, masks_)(k, l)] = slots.pair(static_cast<int>(j));
  }
}

GramPlan planGram(const DeviceTiles& tiles, const GramSlots& slots, const PairSlots& pair_slots, std::size_t first_tile,
                  std::size_t most_rows) {
  GramPlan plan;
  plan.first_tile = first_tile;
  plan.run_begin = {static_cast<cl_int>(first_tile)};
  plan.run_rows = {0};
  plan.slot_begin.resize(tiles.tileCount() + 1);
  std::vector<std::vector<int>> run_slots;
  std::vector<int> row_of_slot(toSize(slots.count()), -1);
  std::size_t tile = first_tile;
  while (tile < tiles.tileCount()) {
    const std::size_t first_entry = plan.entries.size();
    const std::size_t run_end = appendRun(tiles, slots, pair_slots, tile, plan);
    std::vector<int> used = numberRows(std::span(plan.entries).subspan(first_entry), plan.run_rows.back(), row_of_slot);
    if (plan.runs() > 0 && plan.rows() + used.size() > most_rows) {
      plan.entries.resize(first_entry);  // this run is the first of the next plan
      break;
    }
    plan.run_begin.push_back(static_cast<cl_int>(run_end));
    plan.run_rows.push_back(plan.run_rows.back() + static_cast<cl_int>(used.size()));
    run_slots.push_back(std::move(used));
    tile = run_end;
  }
  plan.tile_count = tile - first_tile;
  listRows(run_slots, slots.count(), plan);
  return plan;
}

}  // namespace facezip::compress
