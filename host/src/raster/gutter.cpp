#include "raster/gutter.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "io/counts.hpp"

namespace facezip::raster {
namespace {

/// Rows to the nearest covered texel of the same column, or kFar.
using RowOffset = std::int16_t;
constexpr RowOffset kFar = INT16_MAX;

/// Squared distance of texel x from the covered texel of column `site`.
std::int64_t distance2(int x, int site, const RowOffset* offsets) {
  const std::int64_t dx = x - site;
  const std::int64_t dy = offsets[site];
  return dx * dx + dy * dy;
}

/// Last x that is as near to the site of column a as to that of column b > a.
std::int64_t lastOf(int a, int b, const RowOffset* offsets) {
  const auto height = [&](int column) {
    return std::int64_t{column} * column + std::int64_t{offsets[column]} * offsets[column];
  };
  const std::int64_t numerator = height(b) - height(a);
  const std::int64_t denominator = 2 * std::int64_t{b - a};
  return numerator >= 0 ? numerator / denominator : -((denominator - 1 - numerator) / denominator);
}

class Gutter {
 public:
  Gutter(std::span<const TexelSample> covered, int width, int covered_begin, int covered_end, int begin, int end,
         const Reaches& reaches)
      : covered_(covered),
        width_(width),
        covered_begin_(covered_begin),
        covered_end_(covered_end),
        begin_(begin),
        end_(end),
        reaches_(reaches),
        farthest_(std::max(reaches.gutter, reaches.feather)),
        offsets_(toSize(end - begin, width), kFar) {}

  void fill(std::span<TexelSample> samples) {
    tbb::parallel_for(tbb::blocked_range<int>(0, width_, 256),
                      [&](const tbb::blocked_range<int>& columns) { findRows(columns.begin(), columns.end()); });
    tbb::parallel_for(begin_, end_,
                      [&](int row) { fillRow(row, samples.subspan(index(row - begin_, 0), toSize(width_))); });
  }

 private:
  std::size_t index(int row, int column) const { return toSize(row, width_) + toSize(column); }
  const TexelSample& coveredAt(int row, int column) const { return covered_[index(row - covered_begin_, column)]; }

  /// The nearest covered rows of columns [first, last): from above, then from below.
  void findRows(int first, int last) {
    const auto visit = [&](int row, std::vector<int>& found) {
      for (int x = first; x < last; ++x) {
        int& at = found[toSize(x - first)];
        if (coveredAt(row, x).kind == TexelSample::Kind::kCovered) at = row;
        if (row < begin_ || row >= end_) continue;
        RowOffset& offset = offsets_[index(row - begin_, x)];
        if (std::abs(at - row) <= farthest_ && std::abs(at - row) < std::abs(int{offset})) {
          offset = static_cast<RowOffset>(at - row);
        }
      }
    };
    constexpr int kNowhere = -(1 << 24);
    std::vector<int> found(toSize(last - first), kNowhere);
    for (int row = covered_begin_; row < end_; ++row) visit(row, found);
    std::fill(found.begin(), found.end(), kNowhere);
    for (int row = covered_end_ - 1; row >= begin_; --row) visit(row, found);
  }

  void fillRow(int row, std::span<TexelSample> samples) const {
    const RowOffset* offsets = offsets_.data() + index(row - begin_, 0);
    struct Reach {
      int site;
      int first;  ///< texel from which the site is the nearest
    };
    std::vector<Reach> sites;
    for (int x = 0; x < width_; ++x) {
      if (offsets[x] == kFar) continue;
      while (!sites.empty() &&
             distance2(sites.back().first, x, offsets) < distance2(sites.back().first, sites.back().site, offsets)) {
        sites.pop_back();
      }
      const std::int64_t first = sites.empty() ? 0 : lastOf(sites.back().site, x, offsets) + 1;
      if (first < width_) sites.push_back({x, static_cast<int>(first)});
    }
    std::size_t next = 0;
    for (int x = 0; x < width_ && !sites.empty(); ++x) {
      while (next + 1 < sites.size() && sites[next + 1].first <= x) ++next;
      TexelSample& sample = samples[toSize(x)];
      const int site = sites[next].site;
      const bool outside = sample.kind == TexelSample::Kind::kOutside;
      if (sample.kind != TexelSample::Kind::kEmpty && !outside) continue;
      const std::int64_t reach = outside ? reaches_.feather : reaches_.gutter;
      const std::int64_t distance = distance2(x, site, offsets);
      if (distance > reach * reach || (outside && crossesGap(row, x, row + offsets[site], site))) continue;
      sample = coveredAt(row + offsets[site], site);
      sample.kind = outside ? TexelSample::Kind::kFeather : TexelSample::Kind::kGutter;
      if (outside) sample.fade = fadeAt(std::sqrt(static_cast<double>(distance)));
    }
  }

  /// Whether a texel of no triangle lies between two: they are not neighbours on the surface then.
  bool crossesGap(int row, int column, int to_row, int to_column) const {
    const int steps = std::max(std::abs(to_row - row), std::abs(to_column - column));
    for (int i = 1; i < steps; ++i) {
      const double share = static_cast<double>(i) / steps;
      const int y = static_cast<int>(std::lround(row + share * (to_row - row)));
      const int x = static_cast<int>(std::lround(column + share * (to_column - column)));
      if (coveredAt(y, x).kind == TexelSample::Kind::kEmpty) return true;
    }
    return false;
  }

  std::uint8_t fadeAt(double distance) const {
    const double t = distance / (reaches_.feather + 1.0);
    return static_cast<std::uint8_t>(std::lround(255.0 * (1.0 - t * t * (3.0 - 2.0 * t))));
  }

  std::span<const TexelSample> covered_;
  int width_;
  int covered_begin_;
  int covered_end_;
  int begin_;
  int end_;
  Reaches reaches_;
  int farthest_;
  std::vector<RowOffset> offsets_;  ///< of rows [begin, end)
};

}  // namespace

void fillGutter(std::span<const TexelSample> covered, int width, int covered_begin, int covered_end, int begin, int end,
                const Reaches& reaches, std::span<TexelSample> samples) {
  if (reaches.gutter <= 0 && reaches.feather <= 0) return;
  Gutter(covered, width, covered_begin, covered_end, begin, end, reaches).fill(samples);
}

}  // namespace facezip::raster
