// best_neutral.hpp - a neutral with less of its own scan's noise: where nothing changes, the mean of all scans.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "bands/map_set.hpp"
#include "device/run.hpp"
#include "image/image_file.hpp"

namespace facezip::compress {

/// Blocks of a map's texels that no expression changes, and what the neutral becomes there.
///   I_0'(p) = I_0(p) + s(p) / (N + 1) sum_n (I_n(p) - I_0(p))
/// with s 1 inside still skin and falling to 0 over a block at its edge. A block of 8 x 8 is still where every
/// expression's difference, averaged over it, is below 3 of 255 in each channel: noise averages out, changes do not.
class StillSkin {
 public:
  StillSkin(const image::ImageShape& shape, int expressions);

  /// Looks at rows [begin, end) of the neutral and the expressions; begin is a multiple of 8, and so is end but for the
  /// last rows.
  void look(int begin, int end, std::span<const std::byte> samples);

  /// When all rows were looked at, before apply(): blocks beside one that changes are no longer inside.
  void finish();

  /// Puts I_0' in the place of I_0, rounded where samples are integers.
  void apply(int begin, int end, std::span<std::byte> samples) const;

  /// Share of the blocks that are still.
  double share() const;

 private:
  static constexpr int kSide = 8;

  float stillness(int x, int y) const;

  image::ImageShape shape_;
  int expressions_;
  int columns_;
  int rows_;
  std::vector<std::uint8_t> still_;   ///< [row][column] of blocks
  std::vector<std::uint8_t> inside_;  ///< likewise: with all its neighbours
};

/// Makes the passes over every map see its best neutral. Reads all textures once.
void useBestNeutrals(MapSet& maps, const device::Run& run);

}  // namespace facezip::compress
