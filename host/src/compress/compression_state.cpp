#include "compress/compression_state.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "compress/band_plan.hpp"
#include "compress/compress_stretch.hpp"
#include "compress/refine/refinement.hpp"
#include "package/footprint.hpp"

namespace facezip::compress {

CompressionState::CompressionState(const Capture& open_capture, const std::filesystem::path& package,
                                   const CompressOptions& wanted, device::DeviceContext& device_context,
                                   Progress& shown_progress)
    : capture(open_capture),
      options(wanted),
      context(device_context),
      progress(shown_progress),
      staged(package, package::footprint()),
      buffers(std::make_unique<BandBuffers>(context)) {
  if (options.method == CompressOptions::Method::kCompressStretch) options.differences = kCompressStretchMaps;
}

WeightSpace CompressionState::weightSpace() const {
  const image::ImageShape& shape = maps.maps[maps.reference].samples->shape();
  return {raster::WeightGrid::over(shape.width, shape.height, options.weight_scale), options.differences,
          expressions()};
}

double CompressionState::coveredTexels(const OpenMap& map) const {
  return static_cast<double>(covered_texels[static_cast<std::size_t>(&map - maps.maps.data())]);
}

/// What stays from pass to pass: weights of every set as codes, at the start and as written, one as halves while it
/// is refined, the masks of the cells, the Gram matrices, and the classes of the texels of each raster.
std::uint64_t CompressionState::residentBytes() const {
  constexpr std::uint64_t kMasksOfACell = 8;
  const WeightSpace space = weightSpace();
  const std::uint64_t cells = space.cellCount();
  std::set<const raster::TexelClasses*> classes;
  std::uint64_t class_bytes = 0;
  for (const OpenMap& map : maps.maps) {
    if (classes.insert(map.classes.get()).second) class_bytes += map.classes->bytes();
  }
  return class_bytes + gram_slots.bytes(expressions()) * groups.size() +
         cells * (static_cast<std::uint64_t>(expressions() * options.differences * (2 * weightSets() + 2)) +
                  kMasksOfACell * (sizeof(int) + sizeof(float)) + sizeof(int));
}

int CompressionState::plannedBandRows() const {
  int rows = 0;
  for (const OpenMap& map : maps.maps) {
    const BandCost cost = bandCost(bandShape(*map.samples, 0), options.differences, report.masks);
    const int planned =
        planBandRows(cost, map.samples->shape().height, options.memory_bytes, residentBytes(), context.info());
    rows = rows == 0 ? planned : std::min(rows, planned);
  }
  return rows;
}

int CompressionState::plannedWindowRows(const WeightGroup& group) const {
  return planWindowRows(group.maps, weightSpace(), sweepsHalfCells(context, group.maps), options.memory_bytes,
                        residentBytes(), context.info());
}

void CompressionState::forEachBand(OpenMap& map, const std::string& stage, const MakeTiles& make_tiles,
                                   const std::function<void(const MapBand&)>& visit) {
  forEachMapBand(*map.samples, report.band_rows, *buffers, make_tiles, fmt::format("{}: {}", stage, map.source->name),
                 progress, visit);
}

void CompressionState::forEachBand(OpenMap& map, const std::string& stage, const TextureSource& source,
                                   const std::function<void(const MapBand&)>& visit) {
  forEachBand(
      map, stage, [&](int begin, int end) { return source.tiles(map, begin, end); }, visit);
}

TileMasks CompressionState::weighed(TileMasks tiles, const OpenMap& map, int first_row) const {
  const image::ImageShape& shape = map.samples->shape();
  if (importance) importance->apply(tiles, shape.width, shape.height, first_row);
  return tiles;
}

}  // namespace facezip::compress
