// map_set.hpp - the maps of a capture opened for compression: their textures, rasters and place on the weight grid.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "facezip/capture.hpp"
#include "facezip/geometry/mesh.hpp"
#include "image/sample_bands.hpp"
#include "raster/texel_classes.hpp"
#include "raster/uv_raster.hpp"

namespace facezip::compress {

/// One map, opened.
struct OpenMap {
  const CaptureMap* source = nullptr;
  double metric_weight = 1.0;  ///< how much its errors count: the source's, but 1 where that of every map is 0
  std::unique_ptr<image::SampleBands> samples;
  std::shared_ptr<const raster::UvRaster> raster;       ///< shared by the maps of one size
  std::shared_ptr<const raster::TexelClasses> classes;  ///< of the raster; likewise
};

struct MapSet {
  std::vector<OpenMap> maps;
  std::size_t reference =
      0;  ///< the largest map, whose texels weight_scale counts; the weight grid is made at its size
};

/// A map on the weight grid, among the maps that share a set of weights.
struct GridMap {
  OpenMap* map = nullptr;
  std::size_t index = 0;    ///< in MapSet::maps
  double fit_weight = 1.0;  ///< how much its errors count among those maps
  int weight_scale = 0;     ///< texels of this map per weight cell, per axis
};

/// Opens every texture of the capture and checks them. Rasters are left open.
/// Throws InputError: a texture that does not fit its neutral.
MapSet openMaps(const Capture& capture);

/// How far texels around the region are coded, in texels of each map.
struct Surroundings {
  std::optional<int> gutter;       ///< in gaps of the layout; none: max(16, side / 64)
  std::optional<int> feather = 0;  ///< where the mesh goes on, fading out; none: side / 32
};

/// Makes one raster per size of the maps.
/// mesh, region  as raster::UvRaster takes them
void makeRasters(MapSet& set, const geometry::TriangleMesh& mesh, std::span<const int> region,
                 const Surroundings& surroundings);

/// Makes rasters and classifies their texels, which passes with a gutter but without masks ask for.
void layOutMaps(MapSet& set, const geometry::TriangleMesh& mesh, std::span<const int> region,
                const Surroundings& surroundings);

/// Texels of every map per weight cell, per axis, where the largest has `weight_scale`: all maps share one grid.
/// Throws InputError: maps whose sizes do not share a grid at that scale.
std::vector<int> weightScales(const MapSet& set, int weight_scale);

/// The maps that share a set of weights: all of them, or each alone. Their fit weight is the metric weight, but 1 where
/// that of every map of the group is 0. Pointers are into `set`. Throws what weightScales() throws.
/// weight_scale  of the largest map
std::vector<std::vector<GridMap>> groupMaps(MapSet& set, bool each_alone, int weight_scale);

}  // namespace facezip::compress
