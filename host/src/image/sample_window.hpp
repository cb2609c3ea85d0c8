// sample_window.hpp - a window of rows that slides down the textures of one map.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "image/sample_bands.hpp"

namespace facezip::image {

class SampleWindow {
 public:
  explicit SampleWindow(SampleBands& source) : source_(source) {}

  /// Moves the window to rows [begin, end); neither may go up. Rows that it held already are not read again.
  /// Throws InputError, OutputError.
  void moveTo(int begin, int end);

  int begin() const { return begin_; }
  int end() const { return end_; }
  /// Neutral, then expressions, end() - begin() rows each.
  std::span<const std::byte> samples() const { return samples_; }

 private:
  SampleBands& source_;
  int begin_ = 0;
  int end_ = 0;
  std::vector<std::byte> samples_;
  std::vector<std::byte> next_;
  std::vector<std::byte> fresh_;
};

}  // namespace facezip::image
