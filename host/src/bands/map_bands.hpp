// map_bands.hpp - passes over the texels of one map: samples from disk, tiles and differences on the device.
#pragma once

#include <functional>
#include <span>
#include <string_view>

#include "bands/device_tiles.hpp"
#include "bands/tile_band.hpp"
#include "device/device_context.hpp"
#include "device/pooled_buffer.hpp"
#include "facezip/progress.hpp"
#include "image/sample_bands.hpp"

namespace facezip::compress {

/// What a step of the method gets of one band. References hold until the step returns.
struct MapBand {
  int begin = 0;  ///< first row of the image
  int end = 0;    ///< behind the last
  BandShape shape;
  std::span<const std::byte> samples;  ///< neutral, then expressions, as SampleBand has them
  const TileMasks& masks;              ///< on the host
  const DeviceTiles& tiles;            ///< the same on the device
  const cl::Buffer& differences;       ///< Delta_n of the tiles
};

/// Device memory that all passes of all maps share.
class BandBuffers {
 public:
  explicit BandBuffers(device::DeviceContext& context);
  device::DeviceContext& context;
  DeviceTiles tiles;
  device::PooledBuffer samples;
  device::PooledBuffer neutral;
  device::PooledBuffer differences;
};

/// Shape of the bands of a map, `rows` rows each.
BandShape bandShape(const image::SampleBands& samples, int rows);

/// Gives the tiles of rows [begin, end) of a map; called one band ahead, in another thread.
using MakeTiles = std::function<TileMasks(int begin, int end)>;

/// What a coded neutral decodes to in rows [begin, end), in units of 1/255. Called between two visits.
using NeutralRows = std::function<std::span<const float>(int begin, int end)>;

/// Runs `visit` on every band of a map from top to bottom, with its tiles uploaded and its differences computed.
/// neutral  where set, differences are to that instead of the captured neutral
/// Throws what reading, the device and `visit` throw, and Cancelled.
void forEachMapBand(image::SampleBands& samples, int band_rows, BandBuffers& buffers, const MakeTiles& make_tiles,
                    std::string_view stage, Progress& progress, const std::function<void(const MapBand&)>& visit,
                    const NeutralRows& neutral = {});

}  // namespace facezip::compress
