#include "compress/best_neutral.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>

#include "io/counts.hpp"

namespace facezip::compress {
namespace {

constexpr double kMostChange = 3.0;  // of 255; what a block may differ by on average and be still

/// Calls visit(typed neutral, typed expressions) for the type of the samples.
template <typename Visit>
void withType(image::SampleType type, const Visit& visit) {
  switch (type) {
    case image::SampleType::kUint8:
      return visit(std::uint8_t{});
    case image::SampleType::kUint16:
      return visit(std::uint16_t{});
    case image::SampleType::kFloat32:
      return visit(float{});
  }
}

template <typename Sample>
Sample rounded(double value) {
  if constexpr (std::is_floating_point_v<Sample>) {
    return static_cast<Sample>(value);
  } else {
    return static_cast<Sample>(std::lround(std::clamp(value, 0.0, double{std::numeric_limits<Sample>::max()})));
  }
}

}  // namespace

StillSkin::StillSkin(const image::ImageShape& shape, int expressions)
    : shape_(shape),
      expressions_(expressions),
      columns_(divideUp(shape.width, kSide)),
      rows_(divideUp(shape.height, kSide)),
      still_(toSize(columns_, rows_), 0) {}

void StillSkin::look(int begin, int end, std::span<const std::byte> samples) {
  assert(begin % kSide == 0 && (end % kSide == 0 || end == shape_.height));
  const std::size_t image = toSize(end - begin) * toSize(shape_.width, shape_.channels);
  const double most = kMostChange / static_cast<double>(image::unit255(shape_.type));
  withType(shape_.type, [&](auto type) {
    using Sample = decltype(type);
    const auto* all = reinterpret_cast<const Sample*>(samples.data());
    tbb::parallel_for(0, divideUp(end - begin, kSide), [&](int block_y) {
      const int y_end = std::min(end - begin, (block_y + 1) * kSide);
      for (int block_x = 0; block_x < columns_; ++block_x) {
        const int x_end = std::min(shape_.width, (block_x + 1) * kSide);
        bool still = true;
        for (int n = 1; n <= expressions_ && still; ++n) {
          double sums[4] = {};
          for (int y = block_y * kSide; y < y_end; ++y) {
            for (int x = block_x * kSide; x < x_end; ++x) {
              const std::size_t at = (toSize(y, shape_.width) + toSize(x)) * toSize(shape_.channels);
              for (int c = 0; c < shape_.channels; ++c) {
                const auto i = at + toSize(c);
                sums[c] += static_cast<double>(all[toSize(n) * image + i]) - static_cast<double>(all[i]);
              }
            }
          }
          const double texels = static_cast<double>(y_end - block_y * kSide) * (x_end - block_x * kSide);
          for (int c = 0; c < shape_.channels; ++c) still = still && std::abs(sums[c]) <= most * texels;
        }
        still_[toSize(begin / kSide + block_y, columns_) + toSize(block_x)] = still ? 1 : 0;
      }
    });
  });
}

void StillSkin::finish() {
  inside_.assign(still_.size(), 0);
  for (int y = 0; y < rows_; ++y) {
    for (int x = 0; x < columns_; ++x) {
      bool all = true;
      for (int v = std::max(0, y - 1); v <= std::min(rows_ - 1, y + 1); ++v) {
        for (int u = std::max(0, x - 1); u <= std::min(columns_ - 1, x + 1); ++u) {
          all = all && still_[toSize(v, columns_) + toSize(u)] != 0;
        }
      }
      inside_[toSize(y, columns_) + toSize(x)] = all ? 1 : 0;
    }
  }
}

/// s at a texel: bilinear between the centres of blocks.
float StillSkin::stillness(int x, int y) const {
  const auto place = [](int texel, int blocks, int& first) {
    const float at =
        std::clamp((static_cast<float>(texel) + 0.5f) / kSide - 0.5f, 0.0f, static_cast<float>(blocks - 1));
    first = std::min(static_cast<int>(at), std::max(0, blocks - 2));
    return at - static_cast<float>(first);
  };
  int x0 = 0, y0 = 0;
  const float fx = place(x, columns_, x0), fy = place(y, rows_, y0);
  const auto of = [&](int u, int v) {
    return static_cast<float>(inside_[toSize(std::min(v, rows_ - 1), columns_) + toSize(std::min(u, columns_ - 1))]);
  };
  const float above = of(x0, y0) + fx * (of(x0 + 1, y0) - of(x0, y0));
  const float below = of(x0, y0 + 1) + fx * (of(x0 + 1, y0 + 1) - of(x0, y0 + 1));
  return above + fy * (below - above);
}

void StillSkin::apply(int begin, int end, std::span<std::byte> samples) const {
  const std::size_t image = toSize(end - begin) * toSize(shape_.width, shape_.channels);
  withType(shape_.type, [&](auto type) {
    using Sample = decltype(type);
    auto* all = reinterpret_cast<Sample*>(samples.data());
    tbb::parallel_for(begin, end, [&](int y) {
      for (int x = 0; x < shape_.width; ++x) {
        const float still = stillness(x, y);
        if (still <= 0.0f) continue;
        const std::size_t at = (toSize(y - begin, shape_.width) + toSize(x)) * toSize(shape_.channels);
        for (std::size_t i = at; i < at + toSize(shape_.channels); ++i) {
          const auto neutral = static_cast<double>(all[i]);
          double change = 0.0;
          for (int n = 1; n <= expressions_; ++n) change += static_cast<double>(all[toSize(n) * image + i]) - neutral;
          all[i] = rounded<Sample>(neutral + static_cast<double>(still) * change / (expressions_ + 1));
        }
      }
    });
  });
}

double StillSkin::share() const {
  return static_cast<double>(std::accumulate(still_.begin(), still_.end(), 0L)) / static_cast<double>(still_.size());
}

void useBestNeutrals(MapSet& maps, const device::Run& run) {
  constexpr int kRowsAtOnce = 64;
  for (OpenMap& map : maps.maps) {
    image::SampleBands& samples = *map.samples;
    auto skin = std::make_shared<StillSkin>(samples.shape(), samples.expressions());
    run.progress.stage(fmt::format("still skin: {}", map.source->name), toSize(samples.shape().height));
    samples.forEachBand(kRowsAtOnce, run.progress, [&](const image::SampleBand& band) {
      skin->look(band.begin, band.end, band.samples);
      run.progress.advance(toSize(band.end));
    });
    skin->finish();
    samples.changeNeutral([skin](int begin, int end, std::span<std::byte> rows) { skin->apply(begin, end, rows); });
  }
  run.clock.book("still skin");
}

}  // namespace facezip::compress
