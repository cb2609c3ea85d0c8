#include "compress/texture_source.hpp"

#include "refine/refinement.hpp"

namespace facezip::compress {
namespace {

/// The cells of a band, with the weights that the run time decodes.
void showCells(WeightWindow& window, const EncodedWeights& weights, const GridMap& map, const MapBand& band) {
  const WeightSpace& space = window.space();
  const WindowRows rows = cellRowsOf(band.begin, band.end, map.weight_scale, space.rows);
  std::vector<float> values(static_cast<std::size_t>(rows.count()) * space.rowFloats());
  decodeRows(weights, space, rows.begin, rows.end, values);
  window.set(rows, values, values);
}

GridBand gridBand(const GridMap& map, const MapBand& band) {
  return {band.tiles, band.shape, band.differences, band.begin, map.weight_scale};
}

}  // namespace

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
  showCells(window_, weights_, map, band);
  const cl::Buffer& textures = fit_.computeRounded(gridBand(map, band), window_, ridge_, codes_.encoding, codes_.bits);
  for (const FitError& error : fit_.errors()) squared_error_ += error.plain;
  return textures;
}

BlockTextures::BlockTextures(device::DeviceContext& context, const WeightSpace& space, const EncodedWeights& weights,
                             const MapCodes& codes, int channels)
    : weights_(weights),
      ridge_(ridgeOf(RefinementOptions{}, space)),
      window_(context, space),
      textures_(context, space, {codes.formats, codes.encoding, channels}, blocks::Quality::kNormal, true) {}

TileMasks BlockTextures::tiles(const OpenMap& map, int begin, int end) const {
  return raster::activeTiles(*map.classes, begin, end);
}

void BlockTextures::compute(const GridMap& map, const MapBand& band) {
  showCells(window_, weights_, map, band);
  textures_.setTiles(band.masks);
  textures_.compute(gridBand(map, band), window_, ridge_);
  for (const FitError& error : textures_.errors()) squared_error_ += error.plain;
}

}  // namespace facezip::compress
