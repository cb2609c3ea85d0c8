#include "blend/band_blender.hpp"

#include <algorithm>
#include <cassert>
#include <optional>

#include "blend/blend.hpp"
#include "blend/map_textures.hpp"
#include "io/counts.hpp"

namespace facezip::blend {

static_assert(BandBlender::rowStep() == kTileRows);

struct BandBlender::State {
  device::DeviceContext& context;
  std::shared_ptr<WeightMaps> weights;
  std::vector<std::string> expressions;
  int height;
  TextureShape shape;
  MapReader reader;
  std::optional<TextureRows> textures;  // grows to the largest band that was asked for
  int most_rows = 0;

  /// Sums the weight maps that the loaded rows need.
  const cl::Buffer& blendWeights(std::span<const float> beta) {
    assert(textures);
    requireWeights(beta, expressions);
    const raster::CellRows rows =
        raster::cellRowsOf(textures->begin(), textures->end(), shape.weight_scale, weights->grid().rows);
    weights->blend(beta, rows.begin, rows.end);
    return weights->weights();
  }
};

BandBlender::BandBlender(const Package& package, int map_index, const WeightSets& weights, const Device& device) {
  const PackageMap& map = package.maps()[toSize(map_index)];
  state_ = std::make_unique<State>(State{device.context(), weights[toSize(map.weight_set)], package.expressions(),
                                         map.height, textureShape(map, package.differences()),
                                         MapReader(package, map_index), std::nullopt, 0});
}

BandBlender::~BandBlender() = default;
BandBlender::BandBlender(BandBlender&&) noexcept = default;

int BandBlender::rowsWithin(std::size_t bytes) const {
  // Tiles on the device and a frame of padded rows; what is read at once is small beside them.
  const std::size_t padded = toSize(state_->shape.tilesAcross()) * kTileWidth;
  const std::size_t tile_row_bytes =
      state_->shape.tilesBytes() + kTileRows * 2 * padded * state_->shape.rowBytes() / toSize(state_->shape.width);
  const std::size_t largest = state_->context.info().largest_allocation_bytes / state_->shape.tilesBytes();
  const std::size_t tile_rows = std::clamp<std::size_t>(bytes / tile_row_bytes, 1, std::max<std::size_t>(1, largest));
  const std::size_t needed = toSize(divideUp(state_->height, kTileRows));
  return static_cast<int>(std::min(tile_rows, needed)) * kTileRows;
}

void BandBlender::loadRows(int begin, int end) {
  assert(begin % kTileRows == 0 && (end % kTileRows == 0 || end == state_->height) && end <= state_->height);
  if (!state_->textures || end - begin > state_->most_rows) {
    state_->textures.reset();  // before the larger one is made
    const WeightCodes& grid = state_->weights->grid();
    state_->textures.emplace(state_->context, state_->shape, end - begin, grid.columns, grid.rows);
    state_->most_rows = end - begin;
  }
  state_->textures->setRows(begin, end);
  state_->reader.load(*state_->textures);
}

void BandBlender::blend(std::span<const float> beta, std::span<std::byte> out) {
  const cl::Buffer& weights = state_->blendWeights(beta);
  state_->textures->blend(weights, out);
}

void BandBlender::blendValues(std::span<const float> beta, std::span<float> out) {
  const cl::Buffer& weights = state_->blendWeights(beta);
  state_->textures->blendValues(weights, out);
}

WeightSets loadWeightMaps(const Package& package, const Device& device) {
  return loadWeightMaps(package, device.context());
}

}  // namespace facezip::blend
