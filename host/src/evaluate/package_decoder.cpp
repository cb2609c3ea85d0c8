#include "evaluate/package_decoder.hpp"

namespace facezip::evaluate {

PackageDecoder::PackageDecoder(const Package& package, const Device& device)
    : package_(package),
      device_(device),
      weights_(blend::loadWeightMaps(package, device)),
      beta_(package.expressions().size(), 0.0f) {}

std::uint64_t PackageDecoder::residentBytes() const {
  std::uint64_t cells = 0;
  for (const PackageWeights& grid : package_.weightSets()) {
    cells += static_cast<std::uint64_t>(grid.tile_width) * static_cast<std::uint64_t>(grid.tile_height);
  }
  return cells * static_cast<std::uint64_t>(package_.differences()) * package_.expressions().size();
}

void PackageDecoder::openMap(int map_index) {
  blender_ = std::make_unique<blend::BandBlender>(package_, map_index, weights_, device_);
}

void PackageDecoder::loadRows(int begin, int end) { blender_->loadRows(begin, end); }

void PackageDecoder::setExpressions(std::vector<std::vector<float>> weights) {
  expressions_ = std::move(weights);
  beta_.assign(expressions_.empty() ? package_.expressions().size() : expressions_.size(), 0.0f);
}

void PackageDecoder::decode(std::span<const float> beta, std::span<float> out) {
  if (expressions_.empty()) {
    blender_->blendValues(beta, out);
    return;
  }
  std::vector<float> of_package(package_.expressions().size(), 0.0f);
  for (std::size_t e = 0; e < expressions_.size(); ++e) {
    if (beta[e] == 0.0f) continue;
    for (std::size_t n = 0; n < of_package.size(); ++n) of_package[n] += beta[e] * expressions_[e][n];
  }
  blender_->blendValues(of_package, out);
}

void PackageDecoder::decodeExpression(int expression, std::span<float> out) {
  beta_[static_cast<std::size_t>(expression)] = 1.0f;
  decode(beta_, out);
  beta_[static_cast<std::size_t>(expression)] = 0.0f;
}

}  // namespace facezip::evaluate
