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
  double fit_weight = 1.0;     ///< the same among the maps that share a set of weights with it
  std::unique_ptr<image::SampleBands> samples;
  std::shared_ptr<const raster::UvRaster> raster;       ///< shared by the maps of one size
  std::shared_ptr<const raster::TexelClasses> classes;  ///< of the raster; likewise
  int weight_scale = 0;                                 ///< texels of this map per weight cell, per axis
};

struct MapSet {
  std::vector<OpenMap> maps;
  std::size_t reference =
      0;  ///< the largest map, whose texels weight_scale counts; the weight grid is made at its size
};

/// Opens every texture of the capture and checks them. Rasters and weight scales are left open.
/// Throws InputError: a texture that does not fit its neutral.
MapSet openMaps(const Capture& capture);

/// Makes one raster per size of the maps.
/// mesh, region  as raster::UvRaster takes them
/// gutter  texels; none: max(16, side / 64)
void makeRasters(MapSet& set, const geometry::TriangleMesh& mesh, std::span<const int> region,
                 std::optional<int> gutter);

/// Classifies the texels of the rasters, which passes with a gutter but without masks ask for.
void classifyTexels(MapSet& set);

/// Sets the fit weight of maps that share a set of weights: their metric weight, but 1 where that of each is 0.
void assignFitWeights(std::span<OpenMap* const> maps);

/// Sets the weight scale of every map.
/// weight_scale  of the largest map; the others' follow, since all maps share one weight grid
/// Throws InputError: maps whose sizes do not share a weight grid at that scale.
void assignWeightScales(MapSet& set, int weight_scale);

}  // namespace facezip::compress
