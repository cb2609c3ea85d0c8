// host/shaders/facezip_blend.h, run as C++: the text that GLSL and HLSL compile computes what the reference does.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "reference/blend.hpp"
#include "reference/weight_blend.hpp"

namespace facezip {
namespace {

struct vec2 {
  float x, y;
};
vec2 operator-(vec2 a, vec2 b) { return {a.x - b.x, a.y - b.y}; }
vec2 operator*(vec2 a, vec2 b) { return {a.x * b.x, a.y * b.y}; }
vec2 operator/(vec2 a, float b) { return {a.x / b, a.y / b}; }
vec2 clamp(vec2 a, vec2 low, vec2 high) { return {std::clamp(a.x, low.x, high.x), std::clamp(a.y, low.y, high.y)}; }

struct ivec2 {
  int x, y;
};

struct vec4 {
  vec4(double a, double b, double c, double d)
      : v{static_cast<float>(a), static_cast<float>(b), static_cast<float>(c), static_cast<float>(d)} {}
  vec4() : vec4(0.0, 0.0, 0.0, 0.0) {}
  float v[4];
  float operator[](int i) const { return v[i]; }
  vec4& operator+=(const vec4& other) {
    for (int i = 0; i < 4; ++i) v[i] += other.v[i];
    return *this;
  }
};
template <typename Operation>
vec4 each(const vec4& a, const vec4& b, const Operation& operation) {
  return {operation(a[0], b[0]), operation(a[1], b[1]), operation(a[2], b[2]), operation(a[3], b[3])};
}
vec4 operator+(const vec4& a, const vec4& b) { return each(a, b, std::plus<float>()); }
vec4 operator-(const vec4& a, const vec4& b) { return each(a, b, std::minus<float>()); }
vec4 operator*(const vec4& a, const vec4& b) { return each(a, b, std::multiplies<float>()); }
vec4 operator*(const vec4& a, float b) { return a * vec4(b, b, b, b); }
vec4 mix(const vec4& a, const vec4& b, float t) { return a + (b - a) * t; }
using std::min;

/// Texels of every layer, row-major.
struct Texture {
  int width = 0, height = 0;
  std::vector<vec4> texels;
  const vec4& at(int x, int y, int layer = 0) const {
    return texels.at(static_cast<std::size_t>((layer * height + y) * width + x));
  }
};

std::vector<float> fz_beta;

#define FACEZIP_CPP
#define FZ_DIFFERENCES 6
#define FZ_TEXTURE const Texture&
#define FZ_ARRAY const Texture&
#define FZ_FETCH(t, x, y) (t).at(x, y)
#define FZ_FETCH_LAYER(t, x, y, layer) (t).at(x, y, layer)
#define FZ_SAMPLE_LAYER(t, uv, layer)                              \
  (t).at(static_cast<int>((uv).x * static_cast<float>((t).width)), \
         static_cast<int>((uv).y * static_cast<float>((t).height)), layer)
#define FZ_MIX mix
#define fz_beta fz_beta.data()
#include "../../host/shaders/facezip_blend.h"
#undef fz_beta

constexpr int kWidth = 41, kHeight = 23, kScale = 8, kColumns = 6, kRows = 3, kExpressions = 5, kChannels = 3;

float unit(int code) { return static_cast<float>(code) / 255.0f; }

TEST(ShaderHeader, ComputesWhatTheReferenceDoes) {
  std::mt19937_64 random(11);
  const auto code = [&random] { return static_cast<int>(random() % 256); };
  reference::WeightMaps maps{kColumns, kRows, FZ_DIFFERENCES, kExpressions, {}, {}, {}};
  reference::Textures textures{kWidth, kHeight, kChannels, FZ_DIFFERENCES, kScale, 255.0, {}, {}, {}, {}};
  Texture layers{kColumns, kRows, {}}, codes{kWidth, kHeight, {}}, neutral{kWidth, kHeight, {}};
  for (int i = 0; i < kExpressions * kColumns * kRows * FZ_DIFFERENCES; ++i) {
    maps.codes.push_back(static_cast<unsigned char>(code()));
  }
  for (int i = 0; i < FZ_DIFFERENCES; ++i) {
    maps.scale.push_back((1.0 + 0.1 * i) / 255.0);
    maps.offset.push_back(-0.1 * i);
  }
  for (int n = 0; n < kExpressions; ++n) {
    for (int group = 0; group < 2; ++group) {
      for (int q = 0; q < kColumns * kRows; ++q) {
        const auto channel = [&](int c) {
          const int i = 4 * group + c;
          const std::size_t at = static_cast<std::size_t>((n * kColumns * kRows + q) * FZ_DIFFERENCES + i);
          return i < FZ_DIFFERENCES ? unit(maps.codes[at]) : 0.0f;
        };
        layers.texels.emplace_back(channel(0), channel(1), channel(2), channel(3));
      }
    }
  }
  for (int p = 0; p < kWidth * kHeight; ++p) {
    const int sample[3] = {code(), code(), code()};
    for (const int c : sample) textures.neutral.push_back(c);
    neutral.texels.emplace_back(unit(sample[0]), unit(sample[1]), unit(sample[2]), 0.0f);
  }
  vec4 zero[FZ_DIFFERENCES], scale[FZ_DIFFERENCES];
  for (int i = 0; i < FZ_DIFFERENCES; ++i) {
    textures.codes.emplace_back();
    for (int p = 0; p < kWidth * kHeight; ++p) {
      const int sample[3] = {code(), code(), code()};
      for (const int c : sample) textures.codes.back().push_back(c);
      codes.texels.emplace_back(unit(sample[0]), unit(sample[1]), unit(sample[2]), 0.0f);
    }
    const double step = 0.5 + 0.1 * i, middle = 120 + i;
    textures.scale.push_back({step, step, 2.0 * step});
    textures.offset.push_back({-step * middle, -step * middle, -2.0 * step * middle});
    zero[i] = vec4(middle / 255.0, middle / 255.0, middle / 255.0, 0.0);
    scale[i] = vec4(step, step, 2.0 * step, 0.0);  // times 255 / 255
  }
  fz_beta = {0.7f, 0.0f, -0.4f, 1.0f, 0.25f};
  const std::vector<double> expected =
      reference::blendFrame(textures, reference::blendWeights(maps, fz_beta), kColumns, kRows);

  vec4 weight_scale[2], weight_offset[2];
  for (int group = 0; group < 2; ++group) {
    for (int c = 0; c < 4 && 4 * group + c < FZ_DIFFERENCES; ++c) {
      const std::size_t i = static_cast<std::size_t>(4 * group + c);
      weight_scale[group].v[c] = static_cast<float>(255.0 * maps.scale[i]);
      weight_offset[group].v[c] = static_cast<float>(maps.offset[i]);
    }
  }
  Texture grid{kColumns, 2 * kRows, {}};
  for (int row = 0; row < 2 * kRows; ++row) {
    for (int x = 0; x < kColumns; ++x) {
      const int group = row / kRows;
      grid.texels.push_back(fz_blend_weights(layers, ivec2{x, row % kRows}, kExpressions, 2, group, weight_scale[group],
                                             weight_offset[group], 1.0f));
    }
  }
  const vec2 size{kWidth, kHeight}, cells{kColumns, kRows};
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const vec2 uv{(static_cast<float>(x) + 0.5f) / kWidth, (static_cast<float>(y) + 0.5f) / kHeight};
      const vec2 cell = fz_cell(uv, size, kScale, cells);
      const vec4 two_steps = neutral.at(x, y) + fz_difference(codes, uv, fz_weights(grid, cell, cells, 0),
                                                              fz_weights(grid, cell, cells, 1), zero, scale);
      const auto direct = [&](int group) {
        return fz_weights_in_one_pass(layers, cell, cells, kExpressions, 2, group, weight_scale[group],
                                      weight_offset[group]);
      };
      const vec4 one_pass = neutral.at(x, y) + fz_difference(codes, uv, direct(0), direct(1), zero, scale);
      for (int c = 0; c < kChannels; ++c) {
        const double wanted = expected[static_cast<std::size_t>((y * kWidth + x) * kChannels + c)];
        // Sums of about thirty rounded terms up to 500 in size.
        ASSERT_NEAR(255.0 * static_cast<double>(two_steps[c]), wanted, 2e-3) << x << ' ' << y << ' ' << c;
        ASSERT_NEAR(255.0 * static_cast<double>(one_pass[c]), wanted, 2e-3) << x << ' ' << y << ' ' << c;
      }
    }
  }
}

}  // namespace
}  // namespace facezip
