#include "evaluate/error_distribution.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

#include "io/counts.hpp"

namespace facezip::evaluate {

void ErrorDistribution::add(std::span<const float> values) {
  for (const float value : values) {
    assert(value >= 0.0f);
    // In float first: a value beyond the range of size_t must not be converted.
    const float position = std::min(value * kBinsPerUnit, static_cast<float>(kBins));
    const auto bin = static_cast<std::size_t>(position);
    if (bin >= bins_.size()) bins_.resize(bin + 1, 0);
    ++bins_[bin];
    const double exact = static_cast<double>(value);
    sum_ += exact;
    sum_of_squares_ += exact * exact;
    max_ = std::max(max_, exact);
  }
  count_ += values.size();
}

void ErrorDistribution::add(const ErrorDistribution& other) {
  if (other.bins_.size() > bins_.size()) bins_.resize(other.bins_.size(), 0);
  for (std::size_t b = 0; b < other.bins_.size(); ++b) bins_[b] += other.bins_[b];
  count_ += other.count_;
  sum_ += other.sum_;
  sum_of_squares_ += other.sum_of_squares_;
  max_ = std::max(max_, other.max_);
}

double ErrorDistribution::mean() const { return count_ == 0 ? 0.0 : sum_ / static_cast<double>(count_); }

double ErrorDistribution::rootMeanSquare() const {
  return count_ == 0 ? 0.0 : std::sqrt(sum_of_squares_ / static_cast<double>(count_));
}

double ErrorDistribution::quantile(double share) const {
  const double wanted = share * static_cast<double>(count_);
  std::uint64_t below = 0;
  for (std::size_t b = 0; b < bins_.size() && b < kBins; ++b) {
    below += bins_[b];
    if (static_cast<double>(below) >= wanted) return std::min(max_, static_cast<double>(b + 1) / kBinsPerUnit);
  }
  return max_;
}

std::uint64_t ErrorDistribution::beyond(int limit) const {
  const auto first = std::min(toSize(limit, kBinsPerUnit), bins_.size());
  return std::accumulate(bins_.begin() + static_cast<std::ptrdiff_t>(first), bins_.end(), std::uint64_t{0});
}

}  // namespace facezip::evaluate
