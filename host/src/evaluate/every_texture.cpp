#include "evaluate/every_texture.hpp"

#include <fmt/format.h>

#include <cmath>

#include "bands/covered_texels.hpp"
#include "bands/map_bands.hpp"
#include "blocks/block_encoder.hpp"
#include "blocks/block_format.hpp"
#include "compress/package_form.hpp"
#include "io/counts.hpp"
#include "raster/texel_masks.hpp"

namespace facezip::evaluate {
namespace {
using namespace compress;

/// Whole rows of blocks of every height there is.
constexpr int kBandRows = 240;

/// Adds the squared errors of one texture's covered texels.
double squaredError(std::span<const float> decoded, std::span<const std::uint8_t> captured,
                    std::span<const std::uint32_t> texels, std::size_t channels) {
  double sum = 0.0;
  for (const std::uint32_t texel : texels) {
    for (std::size_t s = texel * channels; s < (texel + 1) * channels; ++s) {
      const double error = static_cast<double>(decoded[s]) - captured[s];
      sum += error * error;
    }
  }
  return sum;
}

}  // namespace

std::string everyTextureKey(BlockFormat format) { return fmt::format("every-{}", blockFormatName(format)); }

std::optional<MapErrors> everyTextureErrors(const OpenMap& map, BlockFormat format, const Subject& subject) {
  const image::ImageShape& shape = map.samples->shape();
  if (shape.type != SampleType::kUint8) return std::nullopt;
  blocks::EncoderOptions options;
  options.format = blocks::formatFor(format, shape.channels);
  options.channels = shape.channels;
  options.quality = blocks::Quality::kNormal;
  options.astc_effort = blocks::AstcEffort{.search = 60.0f};
  const auto encoder = blocks::makeBlockEncoder(subject.device.context(), options);
  std::vector<double> sums(toSize(subject.expressions()), 0.0);
  std::uint64_t covered = 0;
  std::vector<std::byte> coded;
  std::vector<float> decoded;
  subject.progress.stage(fmt::format("every texture in {}: {}", blockFormatName(format), map.source->name),
                         toSize(shape.height));
  map.samples->forEachBand(kBandRows, subject.progress, [&](const image::SampleBand& band) {
    const int rows = band.end - band.begin;
    const BandShape band_shape = bandShape(*map.samples, rows);
    const auto texels = coveredTexels(band_shape, raster::coverageTiles(*map.raster, band.begin, band.end));
    covered += texels.size();
    const std::size_t samples = toSize(rows, shape.width, shape.channels);
    coded.resize(blocks::blockBytes(options.format, shape.width, rows));
    decoded.resize(samples);
    for (std::size_t n = 0; n < sums.size(); ++n) {
      subject.progress.checkCancelled();
      const auto bytes = band.samples.subspan((n + 1) * samples, samples);
      const std::span captured(reinterpret_cast<const std::uint8_t*>(bytes.data()), samples);
      encoder->encode(
          {.width = shape.width, .rows = rows, .channels = shape.channels, .samples = captured, .weights = {}}, coded,
          decoded);
      sums[n] += squaredError(decoded, captured, texels, toSize(shape.channels));
    }
    subject.progress.advance(toSize(band.end));
  });
  MapErrors errors;
  double sum = 0.0;
  const double count = static_cast<double>(covered) * shape.channels;
  for (const double squared : sums) {
    sum += squared;
    errors.per_expression.push_back(std::sqrt(squared / count));
  }
  errors.pooled = std::sqrt(sum / (count * static_cast<double>(sums.size())));
  return errors;
}

std::uint64_t everyTextureBytes(const PackageMap& map, BlockFormat format, int expressions) {
  const std::uint64_t texture = map.sample_type == SampleType::kUint8
                                    ? blocks::blockBytes(blocks::formatFor(format, map.channels), map.width, map.height)
                                    : map.frameBytes();
  return texture * (static_cast<std::uint64_t>(expressions) + 1);
}

}  // namespace facezip::evaluate
