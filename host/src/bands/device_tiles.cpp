#include "bands/device_tiles.hpp"

#include <cassert>

#include "io/counts.hpp"

namespace facezip::compress {

DeviceTiles::DeviceTiles(device::DeviceContext& context)
    : positions_(context, "tile positions", CL_MEM_READ_ONLY),
      mask_begin_(context, "mask lists of the tiles", CL_MEM_READ_ONLY),
      mask_index_(context, "mask indices of the tiles", CL_MEM_READ_ONLY),
      mask_weights_(context, "mask weights of the tiles", CL_MEM_READ_ONLY),
      texel_weights_(context, "texel weights of the tiles", CL_MEM_READ_ONLY),
      fades_(context, "fades of the tiles", CL_MEM_READ_ONLY) {}

void DeviceTiles::upload(const TileMasks& masks) {
  assert(masks.mask_begin.size() == masks.tiles.size() + 1);
  assert(masks.mask_begin.back() == static_cast<int>(masks.mask_index.size()));
  assert(masks.mask_weights.size() == masks.mask_index.size() * kTileTexels);
  assert(masks.texel_weights.size() == masks.tiles.size() * kTileTexels);
  tile_count_ = masks.tiles.size();
  begin_ = masks.mask_begin;
  index_ = masks.mask_index;
  static_assert(sizeof(TilePosition) == 2 * sizeof(cl_int));
  positions_.upload(masks.tiles);
  mask_begin_.upload(masks.mask_begin);
  mask_index_.upload(masks.mask_index);
  mask_weights_.upload(masks.mask_weights);
  texel_weights_.upload(masks.texel_weights);
  has_fades_ = !masks.fades.empty();
  assert(!has_fades_ || masks.fades.size() == masks.texel_weights.size());
  if (has_fades_) fades_.upload(masks.fades);
}

std::span<const int> DeviceTiles::masksOf(std::size_t t) const {
  assert(t < tile_count_);
  return std::span<const int>(index_).subspan(toSize(begin_[t]), toSize(begin_[t + 1] - begin_[t]));
}

}  // namespace facezip::compress
