#include "codes/texture_coder.hpp"

#include "blocks/bc_encoder.hpp"
#include "codes/tile_rows.hpp"
#include "device/strided_copy.hpp"
#include "io/counts.hpp"

namespace facezip::compress {
namespace {

class DeviceTextureCoder final : public TextureCoder {
 public:
  DeviceTextureCoder(device::DeviceContext& context, const blocks::EncoderOptions& options)
      : context_(context), format_(options.format), encoder_(context, options), blocks_(context, "blocks of a band") {}

  void code(const CodedTiles& band, const TexturePlanes& planes, std::span<const float> zero,
            std::span<std::byte> blocks) override {
    const BandShape& shape = band.shape;
    blocks_.reserve(blocks::blockBytes(format_, shape.width, shape.rows));
    if (!blocks.empty()) encoder_.fill(blocks_.buffer(), shape.width, shape.rows, zero);
    if (band.tiles.tileCount() > 0) {
      blocks::DeviceTexels texels;
      texels.layout = blocks::TexelLayout::inTiles(shape.width, shape.rows, shape.channels, band.tiles.positions(),
                                                   band.tiles.tileCount(), planes.textures, planes.texture);
      texels.samples = planes.codes;
      texels.weights = band.weights_buffer;
      encoder_.encodeOnDevice(texels, blocks_.buffer(), planes.codes);
    }
    if (!blocks.empty()) context_.read(blocks_.buffer(), blocks, "blocks of a band");
  }

 private:
  device::DeviceContext& context_;
  blocks::BlockFormat format_;
  blocks::BcEncoder encoder_;
  device::PooledBuffer blocks_;
};

class HostTextureCoder final : public TextureCoder {
 public:
  HostTextureCoder(device::DeviceContext& context, const blocks::EncoderOptions& options)
      : context_(context), format_(options.format), encoder_(blocks::makeBlockEncoder(context, options)) {}

  void code(const CodedTiles& band, const TexturePlanes& planes, std::span<const float> zero,
            std::span<std::byte> blocks) override {
    const BandShape& shape = band.shape;
    tiles_.resize(toSize(band.positions.size(), shape.channels, kTileTexels));
    const device::Strided place = placeOf(band, planes);
    device::readStrided(context_, planes.codes, place, tiles_);
    rows_.resize(toSize(shape.rows, shape.width, shape.channels));
    for (std::size_t i = 0; i < rows_.size(); ++i) rows_[i] = zero[i % zero.size()];
    tilesToRows(band.positions, shape, tiles_, rows_);
    weights_.assign(toSize(shape.rows, shape.width), 0.0f);
    BandShape one_channel = shape;
    one_channel.channels = 1;
    tilesToRows(band.positions, one_channel, band.weights, weights_);
    unwanted_.resize(blocks.empty() ? blocks::blockBytes(format_, shape.width, shape.rows) : 0);
    decoded_.resize(rows_.size());
    encoder_->encode({.width = shape.width,
                      .rows = shape.rows,
                      .channels = shape.channels,
                      .samples = std::span<const float>(rows_),
                      .weights = weights_},
                     blocks.empty() ? std::span(unwanted_) : blocks, decoded_);
    rowsToTiles(band.positions, shape, decoded_, tiles_);
    device::writeStrided(context_, planes.codes, place, tiles_);
  }

 private:
  /// The texture's planes of every tile.
  static device::Strided placeOf(const CodedTiles& band, const TexturePlanes& planes) {
    const std::size_t length = toSize(band.shape.channels, kTileTexels);
    return {toSize(planes.texture) * length, length, toSize(planes.textures) * length, band.positions.size()};
  }

  device::DeviceContext& context_;
  blocks::BlockFormat format_;
  std::unique_ptr<blocks::BlockEncoder> encoder_;
  std::vector<float> tiles_;  // [tile][channel][256]
  std::vector<float> rows_;
  std::vector<float> weights_;
  std::vector<float> decoded_;
  std::vector<std::byte> unwanted_;
};

}  // namespace

std::unique_ptr<TextureCoder> makeTextureCoder(device::DeviceContext& context, const blocks::EncoderOptions& options) {
  if (blocks::isAstc(options.format)) return std::make_unique<HostTextureCoder>(context, options);
  return std::make_unique<DeviceTextureCoder>(context, options);
}

}  // namespace facezip::compress
