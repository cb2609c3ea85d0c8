#include "convert/package_frames.hpp"

#include <algorithm>
#include <cassert>
#include <cstring>

#include "io/counts.hpp"

namespace facezip::convert {
namespace {

/// Rows that are blended at once: enough for the device, little beside a band of all expressions.
constexpr int kRowsAtOnce = 64;

}  // namespace

PackageFrames::PackageFrames(const Package& package, int map_index, const blend::WeightSets& weights,
                             const Device& device)
    : package_(package),
      map_index_(map_index),
      weights_(weights),
      device_(device),
      beta_(package.expressions().size(), 0.0f) {}

void PackageFrames::readRows(int begin, int end, std::span<std::byte> out) {
  const PackageMap& map = package_.maps()[toSize(map_index_)];
  const std::size_t row = toSize(map.width, map.channels);
  const std::size_t frame_bytes = toSize(end - begin) * row * sizeof(float);
  assert(out.size() == (beta_.size() + 1) * frame_bytes);
  if (begin == 0) blender_ = std::make_unique<blend::BandBlender>(package_, map_index_, weights_, device_);
  for (int first = begin; first < end; first += kRowsAtOnce) {
    const int behind = std::min(first + kRowsAtOnce, end);
    blender_->loadRows(first, behind);
    values_.resize(toSize(behind - first) * row);
    for (std::size_t image = 0; image <= beta_.size(); ++image) {
      if (image > 0) beta_[image - 1] = 1.0f;
      blender_->blendValues(beta_, values_);
      if (image > 0) beta_[image - 1] = 0.0f;
      for (float& value : values_) value /= 255.0f;
      std::memcpy(&out[image * frame_bytes + toSize(first - begin) * row * sizeof(float)], values_.data(),
                  values_.size() * sizeof(float));
    }
  }
}

}  // namespace facezip::convert
