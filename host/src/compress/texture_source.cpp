#include "compress/texture_source.hpp"

#include "compress/refine/refinement.hpp"

namespace facezip::compress {

FittedTextures::FittedTextures(device::DeviceContext& context, const WeightSpace& space, const EncodedWeights& weights,
                               const MapCodes& codes)
    : weights_(weights),
      codes_(codes),
      ridge_(ridgeOf(RefinementOptions{}, space)),
      window_(context, space),
      fit_(context, space) {}

TileMasks FittedTextures::tiles(const OpenMap& map, int begin, int end) const {
  return raster::activeTiles(*map.classes, begin, end);
}

const cl::Buffer& FittedTextures::compute(const GridMap& map, const MapBand& band) {
  const WeightSpace& space = window_.space();
  const WindowRows rows = cellRowsOf(band.begin, band.end, map.weight_scale, space.rows);
  std::vector<float> weights(static_cast<std::size_t>(rows.count()) * space.rowFloats());
  decodeRows(weights_, space, rows.begin, rows.end, weights);
  window_.set(rows, weights, weights);
  const GridBand grid_band{band.tiles, band.shape, band.differences, band.begin, map.weight_scale};
  const cl::Buffer& textures = fit_.computeRounded(grid_band, window_, ridge_, codes_.encoding, codes_.bits);
  for (const FitError& error : fit_.errors()) squared_error_ += error.plain;
  return textures;
}

}  // namespace facezip::compress
