// counts.hpp - arithmetic on counts, and places in arrays of several axes.
// Numbers of things are int all over facezip; memory is measured in std::size_t. What stands between them is here.
#pragma once

#include <array>
#include <cassert>
#include <concepts>
#include <cstddef>

namespace facezip {

/// The product of counts of 0 or more, as a size: 52 x 4096 x 4096 x 3 passes the largest int.
template <std::integral... Counts>
constexpr std::size_t toSize(Counts... counts) {
  assert(((counts >= 0) && ...));
  return (static_cast<std::size_t>(counts) * ...);
}

/// How many steps it takes to reach `value`. value  0 or more; step  above 0
template <std::integral Value, std::integral Step>
constexpr Value divideUp(Value value, Step step) {
  return (value + static_cast<Value>(step) - 1) / static_cast<Value>(step);
}

/// Smallest multiple of `step` that is not below `value`.
template <std::integral Value, std::integral Step>
constexpr Value roundUp(Value value, Step step) {
  return divideUp(value, step) * static_cast<Value>(step);
}

/// value / step, rounded down for negative values too. step  above 0
constexpr int divideDown(int value, int step) { return value >= 0 ? value / step : -((step - 1 - value) / step); }

/// Row-major places in an array, the outermost axis first (a small std::mdspan, which gcc 12 has not):
///   const Layout shape(rows, columns, channels);   values[shape(row, column, channel)]
template <std::size_t kAxes>
class Layout {
 public:
  template <std::integral... Extents>
  requires(sizeof...(Extents) == kAxes) constexpr explicit Layout(Extents... extents) : extents_{toSize(extents)...} {}

  /// Entries of the whole array.
  constexpr std::size_t size() const {
    std::size_t product = 1;
    for (const std::size_t extent : extents_) product *= extent;
    return product;
  }

  template <std::integral... Indices>
  requires(sizeof...(Indices) == kAxes) constexpr std::size_t operator()(Indices... indices) const {
    std::size_t place = 0;
    std::size_t axis = 0;
    const auto descend = [&](std::size_t index) {
      assert(index < extents_[axis]);
      place = place * extents_[axis++] + index;
    };
    (descend(toSize(indices)), ...);
    return place;
  }

 private:
  std::array<std::size_t, kAxes> extents_;
};
template <std::integral... Extents>
Layout(Extents...) -> Layout<sizeof...(Extents)>;

}  // namespace facezip
