// band.hpp - a band of texels, on the device with its differences, and the same for the references: what the problems
// of all texel-sized steps start from.
#pragma once

#include <cstring>
#include <vector>

#include "bands/device_tiles.hpp"
#include "bands/difference.hpp"
#include "problems/guarded_buffer.hpp"
#include "problems/masks.hpp"
#include "reference/difference.hpp"

namespace facezip::test {

struct BandProblem {
  /// masks  of the band's tiles; their weights decide what the other steps see of it
  BandProblem(device::DeviceContext& device, const BandShape& band_shape, TileMasks tile_masks, std::uint64_t seed = 1)
      : context(device),
        shape(band_shape),
        masks(std::move(tile_masks)),
        tiles(device),
        samples(shape.sampleBytes()),
        differences(device, compress::differenceBufferBytes(shape, masks.tiles.size())) {
    Hashed hashed(seed);
    if (shape.sample_type == image::SampleType::kFloat32) {
      for (std::size_t i = 0; i < samples.size(); i += sizeof(float)) {
        const float value = hashed.between(-0.5f, 1.5f);
        std::memcpy(samples.data() + i, &value, sizeof(value));
      }
    } else {
      hashed.fill(samples);
    }
    tiles.upload(masks);
    computeDifferences();
  }

  /// To be called again where `samples` changed.
  void computeDifferences() {
    device_samples = context.upload(samples, "samples");
    delta_.clear();
    compress::computeDifferences(context, tiles, shape, device_samples, differences.buffer());
    context.finish();
  }

  std::size_t tileCount() const { return masks.tiles.size(); }
  /// Delta_n as the reference has it, [tile][n][channel][256]; computed when first asked for.
  const std::vector<double>& delta() const {
    if (delta_.empty()) {
      delta_ = reference::differences(sampleValues(), tilePositions(), shape.width, shape.rows, shape.channels,
                                      shape.expressions, static_cast<double>(image::unit255(shape.sample_type)),
                                      masks.fades);
    }
    return delta_;
  }
  Layout<4> deltaLayout() const { return Layout(tileCount(), shape.expressions, shape.channels, kTileTexels); }
  /// Largest difference that samples can have.
  double fullScale() const { return shape.sample_type == image::SampleType::kFloat32 ? 2.0 * 255.0 : 255.0; }

  // What steps must move, and how many texels they see.
  double texels() const { return static_cast<double>(tileCount() * kTileTexels); }
  double sampleBytes() const { return static_cast<double>(shape.sampleBytes()); }
  double differenceBytes() const { return static_cast<double>(compress::differenceBufferBytes(shape, tileCount())); }
  double maskBytes() const { return static_cast<double>(masks.mask_weights.size() * sizeof(float)); }
  double texelWeightBytes() const { return texels() * sizeof(float); }

  device::DeviceContext& context;
  BandShape shape;
  TileMasks masks;
  compress::DeviceTiles tiles;
  std::vector<std::byte> samples;  ///< neutral first, then the expressions
  cl::Buffer device_samples;
  GuardedBuffer differences;

 private:
  std::vector<double> sampleValues() const {
    const std::size_t bytes = image::sampleBytes(shape.sample_type);
    std::vector<double> values(samples.size() / bytes);
    for (std::size_t i = 0; i < values.size(); ++i) {
      const std::byte* sample = samples.data() + i * bytes;
      if (shape.sample_type == image::SampleType::kUint8) {
        values[i] = std::to_integer<int>(*sample);
      } else if (shape.sample_type == image::SampleType::kUint16) {
        std::uint16_t value;
        std::memcpy(&value, sample, bytes);
        values[i] = value;
      } else {
        float value;
        std::memcpy(&value, sample, bytes);
        values[i] = static_cast<double>(value);
      }
    }
    return values;
  }

  /// Column and row of tiles, two ints a tile.
  std::vector<int> tilePositions() const {
    std::vector<int> positions;
    for (const compress::TilePosition& tile : masks.tiles) positions.insert(positions.end(), {tile.x, tile.y});
    return positions;
  }

  mutable std::vector<double> delta_;
};

}  // namespace facezip::test
