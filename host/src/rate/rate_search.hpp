// rate_search.hpp - finds the number of difference textures and the weight scale that a target or a budget asks for.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "bands/map_set.hpp"
#include "facezip/compress.hpp"
#include "rate/rate_choice.hpp"
#include "rate/rate_estimate.hpp"

namespace facezip::compress {

/// "4 differences in astc-6x6 with weights at 1/8", for messages.
std::string describe(const RatePoint& point);

/// Attempts one after the other: the estimate says what to try, and what was reached corrects it.
class RateSearch {
 public:
  /// options, maps  must outlive this. Throws InputError if the smallest package is beyond the budget.
  RateSearch(const CompressOptions& options, const MapSet& maps);

  /// To be shown the texels before the first choose().
  RateEstimate& estimate() { return estimate_; }

  /// The package of the fewest bytes.
  RatePoint smallest() const;

  /// What to try next.
  /// fits  whether --memory holds a point's weights; asked once of every point
  /// Throws InputError where nothing that is left can meet the target.
  RatePoint choose(const std::function<bool(const RatePoint&)>& fits);

  /// True if what the last choose() led to misses the target.
  /// reached  RMSE of what was written
  bool misses(double reached);

  /// What the last choose() gave.
  const std::optional<RatePoint>& tried() const { return tried_; }

  /// Points worth trying, by size; empty before choose().
  const std::vector<RatePoint>& curve() const { return curve_; }

 private:
  void keepWhatFits(const std::function<bool(const RatePoint&)>& fits);
  RatePoint lastResort() const;

  const CompressOptions& options_;
  std::vector<RateFormats> formats_;
  RateEstimate estimate_;
  std::vector<RatePoint> curve_;
  std::optional<RatePoint> tried_;
  double calibration_ = 1.0;  ///< error that was reached over what the estimate had said; at least 1
  double reached_ = 0.0;      ///< RMSE of the last attempt, where there is a target
};

}  // namespace facezip::compress
