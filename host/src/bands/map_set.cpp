#include "bands/map_set.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

namespace facezip::compress {
namespace {

/// Texels of a map of `side` per weight cell when the largest map, of `reference_side`, has `weight_scale`; 0 if there
/// is no whole number of them.
int scaleOf(int side, int reference_side, int weight_scale) {
  const long texels = static_cast<long>(side) * weight_scale;
  return texels % reference_side == 0 ? static_cast<int>(texels / reference_side) : 0;
}

}  // namespace

MapSet openMaps(const Capture& capture) {
  MapSet set;
  const bool any_counts = std::any_of(capture.maps.begin(), capture.maps.end(),
                                      [](const CaptureMap& source) { return source.metric_weight > 0.0; });
  for (const CaptureMap& source : capture.maps) {
    OpenMap map;
    map.source = &source;
    map.metric_weight = any_counts ? source.metric_weight : 1.0;
    map.samples = std::make_unique<image::SampleBands>(source, capture.expressions);
    set.maps.push_back(std::move(map));
    const image::ImageShape& shape = set.maps.back().samples->shape();
    const image::ImageShape& largest = set.maps[set.reference].samples->shape();
    if (static_cast<long>(shape.width) * shape.height > static_cast<long>(largest.width) * largest.height) {
      set.reference = set.maps.size() - 1;
    }
  }
  return set;
}

void makeRasters(MapSet& set, const geometry::TriangleMesh& mesh, std::span<const int> region,
                 const Surroundings& surroundings) {
  std::map<std::pair<int, int>, std::shared_ptr<const raster::UvRaster>> rasters;
  for (OpenMap& map : set.maps) {
    const image::ImageShape& shape = map.samples->shape();
    auto& raster = rasters[{shape.width, shape.height}];
    if (!raster) {
      const int side = std::max(shape.width, shape.height);
      raster = std::make_shared<raster::UvRaster>(mesh, region, shape.width, shape.height,
                                                  surroundings.gutter.value_or(std::max(16, side / 64)),
                                                  surroundings.feather.value_or(side / 32));
    }
    map.raster = raster;
  }
}

void layOutMaps(MapSet& set, const geometry::TriangleMesh& mesh, std::span<const int> region,
                const Surroundings& surroundings) {
  makeRasters(set, mesh, region, surroundings);
  std::map<const raster::UvRaster*, std::shared_ptr<const raster::TexelClasses>> classes;
  for (OpenMap& map : set.maps) {
    auto& one = classes[map.raster.get()];
    if (!one) one = std::make_shared<raster::TexelClasses>(*map.raster);
    map.classes = one;
  }
}

std::vector<int> weightScales(const MapSet& set, int weight_scale) {
  const image::ImageShape& reference = set.maps[set.reference].samples->shape();
  std::vector<int> scales;
  for (const OpenMap& map : set.maps) {
    const image::ImageShape& shape = map.samples->shape();
    const int across = scaleOf(shape.width, reference.width, weight_scale);
    const int down = scaleOf(shape.height, reference.height, weight_scale);
    const auto cells = [](int side, int scale) { return (side + scale - 1) / scale; };
    const bool same_grid = across > 0 && across == down &&
                           cells(shape.width, across) == cells(reference.width, weight_scale) &&
                           cells(shape.height, down) == cells(reference.height, weight_scale);
    if (!same_grid) {
      throw InputError(
          {map.source->neutral.string(), fmt::format("map \"{}\"", map.source->name),
           fmt::format("a size that divides the {} x {} of map \"{}\" by a factor of --weight-scale {}",
                       reference.width, reference.height, set.maps[set.reference].source->name, weight_scale),
           fmt::format("{} x {}", shape.width, shape.height), "resize the map"});
    }
    scales.push_back(across);
  }
  return scales;
}

std::vector<std::vector<GridMap>> groupMaps(MapSet& set, bool each_alone, int weight_scale) {
  const std::vector<int> scales = weightScales(set, weight_scale);
  std::vector<std::vector<GridMap>> groups(each_alone ? set.maps.size() : 1);
  for (std::size_t m = 0; m < set.maps.size(); ++m) {
    groups[each_alone ? m : 0].push_back({&set.maps[m], m, set.maps[m].metric_weight, scales[m]});
  }
  for (std::vector<GridMap>& group : groups) {
    const bool any_counts = std::ranges::any_of(group, [](const GridMap& map) { return map.fit_weight > 0.0; });
    for (GridMap& map : group) map.fit_weight = any_counts ? map.fit_weight : 1.0;
  }
  return groups;
}

}  // namespace facezip::compress
