#include "evaluate/map_measurement.hpp"

#include "bands/covered_texels.hpp"
#include "evaluate/blend_error.hpp"
#include "evaluate/normal_angle.hpp"
#include "evaluate/texel_errors.hpp"

namespace facezip::evaluate {
namespace {

ErrorDistribution pooled(std::span<const ErrorDistribution> distributions) {
  ErrorDistribution sum;
  for (const ErrorDistribution& distribution : distributions) sum.add(distribution);
  return sum;
}

}  // namespace

ErrorDistribution PackageErrors::pooledTexels() const { return pooled(texels); }
ErrorDistribution PackageErrors::pooledAngles() const { return pooled(angles); }

MapMeasurement::MapMeasurement(std::vector<PackageDecoder*> decoders, int expressions, const Wanted& wanted)
    : decoders_(std::move(decoders)), expressions_(expressions), wanted_(wanted), errors_(decoders_.size()) {
  const auto count = static_cast<std::size_t>(expressions);
  for (PackageErrors& errors : errors_) {
    errors.texels.resize(count);
    if (wanted.angles) errors.angles.resize(count);
    errors.blends.resize(wanted.blend_weights.size());
  }
}

void MapMeasurement::addBand(int begin, int end, std::span<const std::byte> samples, const compress::BandShape& shape,
                             std::span<const std::uint32_t> texels) {
  const std::size_t values =
      samples.size() / image::sampleBytes(shape.sample_type) / static_cast<std::size_t>(shape.expressions + 1);
  captured_.resize(values);
  decoded_.resize(values);
  texel_errors_.resize(texels.size());
  for (PackageDecoder* decoder : decoders_) decoder->loadRows(begin, end);
  for (int image = 0; image <= expressions_; ++image) {
    if (image == 0 && wanted_.pictures == nullptr) continue;
    compress::toValues(compress::bandImage(samples, shape, image), shape.sample_type, captured_);
    if (wanted_.pictures != nullptr) wanted_.pictures->addCaptured(image, begin, shape, captured_);
    for (std::size_t d = 0; image > 0 && d < decoders_.size(); ++d) addExpression(d, image - 1, begin, shape, texels);
  }
  addBlends(samples, shape, texels);
}

void MapMeasurement::addExpression(std::size_t decoder, int expression, int begin, const compress::BandShape& shape,
                                   std::span<const std::uint32_t> texels) {
  const auto n = static_cast<std::size_t>(expression);
  PackageErrors& errors = errors_[decoder];
  decoders_[decoder]->decodeExpression(expression, decoded_);
  texelErrors(decoded_, captured_, shape.channels, texels, texel_errors_);
  errors.texels[n].add(texel_errors_);
  if (wanted_.pictures != nullptr) {
    wanted_.pictures->addDecoded(decoder, expression, begin, shape, decoded_, texels, texel_errors_);
  }
  if (wanted_.angles) {
    normalAngles(decoded_, captured_, shape.channels, texels, texel_errors_);
    errors.angles[n].add(texel_errors_);
  }
}

void MapMeasurement::addBlends(std::span<const std::byte> samples, const compress::BandShape& shape,
                               std::span<const std::uint32_t> texels) {
  for (std::size_t v = 0; v < wanted_.blend_weights.size(); ++v) {
    blendCaptured(samples, shape, wanted_.blend_weights[v], texels, captured_);
    for (std::size_t d = 0; d < decoders_.size(); ++d) {
      decoders_[d]->decode(wanted_.blend_weights[v], decoded_);
      texelErrors(decoded_, captured_, shape.channels, texels, texel_errors_);
      errors_[d].blends[v].add(texel_errors_);
    }
  }
}

}  // namespace facezip::evaluate
