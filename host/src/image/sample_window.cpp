#include "image/sample_window.hpp"

#include <algorithm>
#include <cassert>
#include <cstring>

namespace facezip::image {

void SampleWindow::moveTo(int begin, int end) {
  assert(begin >= begin_ && end >= end_ && begin <= end);
  const std::size_t row_bytes = source_.rowBytes();
  const auto rows = [row_bytes](int count) { return static_cast<std::size_t>(count) * row_bytes; };
  const int kept = std::max(0, end_ - begin);  // the last rows of the old window are the first of the new
  const int fresh_begin = begin + kept;
  fresh_.resize(source_.bandBytes(end - fresh_begin));
  if (end > fresh_begin) source_.readRows(fresh_begin, end, fresh_);
  next_.resize(source_.bandBytes(end - begin));
  for (std::size_t image = 0; image <= static_cast<std::size_t>(source_.expressions()); ++image) {
    std::byte* out = next_.data() + image * rows(end - begin);
    if (kept > 0) std::memcpy(out, samples_.data() + image * rows(end_ - begin_) + rows(begin - begin_), rows(kept));
    if (end > fresh_begin)
      std::memcpy(out + rows(kept), fresh_.data() + image * rows(end - fresh_begin), rows(end - fresh_begin));
  }
  samples_.swap(next_);
  begin_ = begin;
  end_ = end;
}

}  // namespace facezip::image
