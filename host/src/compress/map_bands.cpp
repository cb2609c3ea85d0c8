#include "compress/map_bands.hpp"

#include "compress/difference.hpp"

namespace facezip::compress {

BandBuffers::BandBuffers(device::DeviceContext& device_context)
    : context(device_context),
      tiles(device_context),
      samples(device_context, "samples of a band", CL_MEM_READ_ONLY),
      differences(device_context, "differences of a band") {}

BandShape bandShape(const image::SampleBands& samples, int rows) {
  const image::ImageShape& shape = samples.shape();
  return {shape.width, rows, shape.channels, samples.expressions(), shape.type};
}

void forEachMapBand(image::SampleBands& samples, int band_rows, BandBuffers& buffers, const MakeTiles& make_tiles,
                    std::string_view stage, Progress& progress, const std::function<void(const MapBand&)>& visit) {
  progress.stage(stage, static_cast<std::size_t>(samples.shape().height));
  samples.forEachBand(band_rows, progress, [&](const image::SampleBand& band) {
    const BandShape shape = bandShape(samples, band.end - band.begin);
    const TileMasks masks = make_tiles(band.begin, band.end);
    buffers.tiles.upload(masks);
    const cl::Buffer& raw = buffers.samples.upload(band.samples);
    const cl::Buffer& differences = buffers.differences.reserve(differenceBufferBytes(shape, masks.tiles.size()));
    computeDifferences(buffers.context, buffers.tiles, shape, raw, differences);
    visit({band.begin, band.end, shape, band.samples, masks, buffers.tiles, differences});
    buffers.context.finish();  // the next band reuses the buffers
    progress.advance(static_cast<std::size_t>(band.end));
  });
}

}  // namespace facezip::compress
