#include "rate/rate_search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <string>
#include <utility>

#include "facezip/error.hpp"

namespace facezip::compress {
namespace {

constexpr int kWeightScales[] = {4, 8, 16, 32};

std::vector<RateFormats> formatsOf(const CompressOptions& options) {
  if (options.format_choice.empty()) {
    return {{options.texture_format, options.difference_format ? options.difference_format : options.texture_format}};
  }
  std::vector<RateFormats> formats;
  for (const BlockFormat format : options.format_choice) formats.push_back({format, format});
  return formats;
}

}  // namespace

std::string describe(const RatePoint& point) {
  const std::string format =
      point.difference_format ? fmt::format(" in {}", blockFormatName(*point.difference_format)) : "";
  return fmt::format("{} difference{}{} with weights at 1/{}{}", point.differences, point.differences == 1 ? "" : "s",
                     format, point.weight_scale, point.weights_per_map ? " for each map" : "");
}

RateSearch::RateSearch(const CompressOptions& options, const MapSet& maps)
    : options_(options),
      formats_(formatsOf(options)),
      estimate_(maps, options.further_weight_maps, options.weight_sets, kWeightScales) {
  // Sizes are known before any texel is.
  const RatePoint least = smallest();
  if (options.budget_bytes && least.bytes > *options.budget_bytes) {
    throw InputError({"--budget", "", fmt::format("at least {} bytes, for {}", least.bytes, describe(least)),
                      fmt::format("{}", *options.budget_bytes), "raise it, or compress smaller textures"});
  }
}

RatePoint RateSearch::smallest() const { return efficientPoints(estimate_.curve(formats_)).front(); }

RatePoint RateSearch::choose(const std::function<bool(const RatePoint&)>& fits) {
  if (curve_.empty()) {
    curve_ = efficientPoints(estimate_.curve(formats_));
    keepWhatFits(fits);
  }
  const std::optional<RatePoint> chosen = chooseRate(curve_, options_.target_rmse, options_.budget_bytes, calibration_);
  tried_ = chosen ? *chosen : lastResort();
  return *tried_;
}

/// Drops the points whose weights do not fit the memory. Where nothing would be left to choose from all stay, and
/// planning says what is missing.
void RateSearch::keepWhatFits(const std::function<bool(const RatePoint&)>& fits) {
  std::vector<RatePoint> held;
  std::copy_if(curve_.begin(), curve_.end(), std::back_inserter(held), fits);
  if (chooseRate(held, std::nullopt, options_.budget_bytes, 1.0)) curve_ = std::move(held);
}

/// The best point there is, where the estimate says that none reaches the target. It may be wrong: it is tried where
/// that was found of another, or it is not too far off. Throws InputError where there is no hope.
RatePoint RateSearch::lastResort() const {
  constexpr double kMostPessimism = 2.0;  // estimates of small captures are up to 1.4 times what is reached
  const RatePoint best = *chooseRate(curve_, std::nullopt, options_.budget_bytes, 1.0);
  const bool tried = tried_ == best;
  if (!tried && best.rmse <= kMostPessimism * *options_.target_rmse) return best;
  throw InputError(
      {"--target-rmse", "",
       fmt::format("at least {:.3f}, which {} {}{}", tried ? reached_ : best.rmse, describe(best),
                   tried ? "reach" : "are expected to reach", options_.budget_bytes ? " within the budget" : ""),
       fmt::format("{}", *options_.target_rmse), "raise it, or the budget where there is one"});
}

bool RateSearch::misses(double reached) {
  if (!options_.target_rmse || reached <= *options_.target_rmse) return false;
  constexpr double kNotAgain = 1.0 + 1e-9;  // rounding must not let the same point pass
  calibration_ = std::max(reached / tried_->rmse * kNotAgain, calibration_);
  reached_ = reached;
  return true;
}

}  // namespace facezip::compress
