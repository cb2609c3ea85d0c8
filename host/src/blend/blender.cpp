#include <fmt/format.h>

#include <algorithm>
#include <deque>

#include "blend/blend.hpp"
#include "blend/map_textures.hpp"
#include "blend/weight_blend.hpp"
#include "facezip/blend.hpp"
#include "io/counts.hpp"

namespace facezip {
namespace {

/// Rows whose tiles and whose frame fit into one buffer each of the device.
int rowsInOneBuffer(const blend::TextureShape& shape, int height, const DeviceInfo& device) {
  const std::size_t padded_row =
      toSize(shape.tilesAcross()) * blend::kTileWidth * toSize(shape.channels) * image::sampleBytes(shape.sample_type);
  const std::size_t largest = std::max(shape.tilesBytes(), padded_row * blend::kTileRows);
  const std::size_t tile_rows = std::max<std::size_t>(1, device.largest_allocation_bytes / largest);
  const std::size_t needed = toSize(divideUp(height, blend::kTileRows));
  return static_cast<int>(std::min(tile_rows, needed)) * blend::kTileRows;
}

/// All rows of one map, in as few pieces as the device's largest buffer allows.
std::deque<blend::TextureRows> loadMap(const Package& package, int map_index, const blend::WeightCodes& grid,
                                       device::DeviceContext& context) {
  const PackageMap& map = package.maps()[toSize(map_index)];
  const blend::TextureShape shape = blend::textureShape(map, package.differences());
  const int most_rows = rowsInOneBuffer(shape, map.height, context.info());
  blend::MapReader reader(package, map_index);
  std::deque<blend::TextureRows> pieces;
  for (int begin = 0; begin < map.height; begin += most_rows) {
    const int end = std::min(begin + most_rows, map.height);
    pieces.emplace_back(context, shape, end - begin, grid.columns, grid.rows);
    pieces.back().setRows(begin, end);
    reader.load(pieces.back());
  }
  return pieces;
}

}  // namespace

struct Blender::State {
  Device device;  // keeps the context alive
  std::vector<std::string> expressions;
  std::vector<PackageMap> maps;
  std::vector<std::shared_ptr<blend::WeightMaps>> weights;  // per set
  std::vector<std::deque<blend::TextureRows>> textures;     // per map
  std::vector<float> gains;                                 // N, of expressions
  std::vector<float> tuned;                                 // N: frames allocate nothing

  blend::WeightMaps& weightsOf(std::size_t map) { return *weights[toSize(maps[map].weight_set)]; }
};

Blender::Blender(const Package& package, const Device& device)
    : state_(std::make_unique<State>(State{device,
                                           package.expressions(),
                                           package.maps(),
                                           blend::loadWeightMaps(package, device.context()),
                                           {},
                                           {},
                                           {}})) {
  for (std::size_t m = 0; m < state_->maps.size(); ++m) {
    const blend::WeightCodes& grid = state_->weightsOf(m).grid();
    state_->textures.push_back(loadMap(package, static_cast<int>(m), grid, device.context()));
  }
  state_->gains.assign(state_->expressions.size(), 1.0f);
  state_->tuned.resize(state_->expressions.size());
  setWeights(std::vector<float>(state_->expressions.size(), 0.0f));
}

Blender::~Blender() = default;
Blender::Blender(Blender&&) noexcept = default;
Blender& Blender::operator=(Blender&&) noexcept = default;

void Blender::setWeights(std::span<const float> beta) {
  blend::requireWeights(beta, state_->expressions);
  for (std::size_t n = 0; n < beta.size(); ++n) state_->tuned[n] = beta[n] * state_->gains[n];
  for (const std::shared_ptr<blend::WeightMaps>& set : state_->weights) set->blend(state_->tuned);
}

void Blender::setGain(const Gain& gain) {
  bool fits = gain.expressions.size() == state_->expressions.size() && gain.cells.size() == state_->weights.size();
  for (std::size_t set = 0; fits && set < gain.cells.size(); ++set) {
    fits = gain.cells[set].empty() || gain.cells[set].size() == state_->weights[set]->grid().cellCount();
  }
  if (!fits) throw InputError({"", "gain", "one that was made for this package", "one of another shape", ""});
  state_->gains = gain.expressions;
  for (std::size_t set = 0; set < gain.cells.size(); ++set) state_->weights[set]->setGain(gain.cells[set]);
}

void Blender::blend(int map_index, std::span<std::byte> out) {
  if (map_index < 0 || map_index >= static_cast<int>(state_->maps.size())) {
    throw InputError(
        {"", "map index", fmt::format("0 to {}", state_->maps.size() - 1), fmt::format("{}", map_index), ""});
  }
  const PackageMap& map = state_->maps[toSize(map_index)];
  if (out.size() != map.frameBytes()) {
    throw InputError({"", fmt::format("memory for a frame of {}", map.name), fmt::format("{} bytes", map.frameBytes()),
                      fmt::format("{} bytes", out.size()), ""});
  }
  for (blend::TextureRows& rows : state_->textures[toSize(map_index)]) {
    const std::size_t row_bytes = rows.shape().rowBytes();
    rows.blend(state_->weightsOf(toSize(map_index)).weights(),
               out.subspan(toSize(rows.begin()) * row_bytes, toSize(rows.end() - rows.begin()) * row_bytes));
  }
}

}  // namespace facezip
