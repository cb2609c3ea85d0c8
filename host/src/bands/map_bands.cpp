#include "bands/map_bands.hpp"

#include "bands/difference.hpp"
#include "io/counts.hpp"

namespace facezip::compress {

BandBuffers::BandBuffers(device::DeviceContext& device_context)
    : context(device_context),
      tiles(device_context),
      samples(device_context, "samples of a band", CL_MEM_READ_ONLY),
      neutral(device_context, "decoded neutral of a band", CL_MEM_READ_ONLY),
      differences(device_context, "differences of a band") {}

BandShape bandShape(const image::SampleBands& samples, int rows) {
  const image::ImageShape& shape = samples.shape();
  return {shape.width, rows, shape.channels, samples.expressions(), samples.sampleType()};
}

void forEachMapBand(image::SampleBands& samples, int band_rows, BandBuffers& buffers, const MakeTiles& make_tiles,
                    std::string_view stage, Progress& progress, const std::function<void(const MapBand&)>& visit,
                    const NeutralRows& neutral) {
  progress.stage(stage, toSize(samples.shape().height));
  TileMasks tiles[2];  // of the band at work and the one that is being read
  const auto tilesOf = [&](int begin) -> TileMasks& { return tiles[begin / band_rows % 2]; };
  const auto prepare = [&](int begin, int end) { tilesOf(begin) = make_tiles(begin, end); };
  const auto work = [&](const image::SampleBand& band) {
    BandShape shape = bandShape(samples, band.end - band.begin);
    shape.neutral_decoded = static_cast<bool>(neutral);
    const TileMasks& masks = tilesOf(band.begin);
    buffers.tiles.upload(masks);
    const cl::Buffer& raw = buffers.samples.upload(band.samples);
    const cl::Buffer& differences = buffers.differences.reserve(differenceBufferBytes(shape, masks.tiles.size()));
    if (neutral) {
      const cl::Buffer& decoded = buffers.neutral.upload(neutral(band.begin, band.end));
      computeDifferences(buffers.context, buffers.tiles, shape, raw, decoded, differences);
    } else {
      computeDifferences(buffers.context, buffers.tiles, shape, raw, differences);
    }
    visit({band.begin, band.end, shape, band.samples, masks, buffers.tiles, differences});
    buffers.context.finish();  // the next band reuses the buffers
    progress.advance(toSize(band.end));
  };
  samples.forEachBand(band_rows, progress, work, prepare);
}

}  // namespace facezip::compress
