// error_distribution.hpp - mean, root mean square, largest value and quantiles of errors that come piece by piece.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace facezip::evaluate {

/// Sums in double in the order of the calls, and a histogram: bins of 1/64 over [0, 256) and one for what lies above.
/// Fine enough for errors in 1/255 of full scale and for angles in degrees; errors of float images may pass 256.
class ErrorDistribution {
 public:
  static constexpr int kBinsPerUnit = 64;
  static constexpr int kBins = 256 * kBinsPerUnit;

  /// values  finite, 0 or more
  void add(std::span<const float> values);
  void add(const ErrorDistribution& other);

  std::uint64_t count() const { return count_; }
  double mean() const;            ///< 0 when nothing was added
  double rootMeanSquare() const;  ///< 0 when nothing was added
  double max() const { return max_; }
  /// The smallest bin edge that at least `share` of the values do not pass; at most max(), and max() above 256.
  /// share  in (0, 1]
  double quantile(double share) const;
  /// How many values are `limit` or more. limit  0 to 256, a whole number
  std::uint64_t beyond(int limit) const;

 private:
  std::uint64_t count_ = 0;
  double sum_ = 0.0;
  double sum_of_squares_ = 0.0;
  double max_ = 0.0;
  std::vector<std::uint64_t> bins_;  ///< grows to the largest bin in use: most errors are small
};

}  // namespace facezip::evaluate
