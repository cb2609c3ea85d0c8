#include "compress/weight_set_choice.hpp"

#include <fmt/format.h>

#include <array>
#include <span>
#include <vector>

namespace facezip::compress {
namespace {

constexpr int kBits = 8;  // those of 16 are chosen later, and change both sides of the comparison alike

std::vector<RatePoint> pointsLike(const PackageForm& form, const RateEstimate& estimate) {
  RateFormats formats;
  if (form.blocks) formats = {form.blocks->neutral, form.blocks->differences};
  std::vector<RatePoint> points = estimate.curve(std::array{formats});
  std::erase_if(points, [](const RatePoint& point) { return point.code_bits != kBits; });
  return points;
}

}  // namespace

std::optional<RateEstimate> estimateWeightSets(const CompressOptions& options, const MapSet& maps) {
  const bool fits = options.method == Method::kRefined || options.method == Method::kClosedLoop;
  if (!fits || options.weight_sets != WeightSets::kAuto || maps.maps.size() == 1) return std::nullopt;
  return std::optional<RateEstimate>(std::in_place, maps, options.further_weight_maps, WeightSets::kAuto,
                                     std::span(&options.weight_scale, 1));
}

PackageForm chooseWeightSets(const RateEstimate& estimate, const CompressionJob& job, PackageForm form) {
  PackageForm own = form;
  own.weights_per_map = true;
  if (!ownWeightsPay(pointsLike(form, estimate), form.differences) || !fitsMemory(job, own)) return form;
  job.run.progress.note(
      fmt::format("each of the {} maps gets weights of its own: what they take gains more than as many bytes of "
                  "further difference textures",
                  job.maps.maps.size()));
  return own;
}

}  // namespace facezip::compress
