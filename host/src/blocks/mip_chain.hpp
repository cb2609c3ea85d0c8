// mip_chain.hpp - the mip levels of a texture, from its rows as they come.
// A level has half the texels of the one before along each side, rounded down, as every graphics API counts them. Its
// texel i is the mean over what samplers take it for, [i n / m, (i + 1) n / m) of the n texels that become m: two
// texels, or, where n is odd, three in part. Means are of the samples as they are stored, which blending is linear in:
// a level of a blend is the blend of the levels, but for coverage and rounding.
#pragma once

#include <functional>
#include <span>
#include <vector>

namespace facezip::blocks {

/// Texels count by their weights (coverage, from 0 to 1): those that nothing covers do not bleed into those beside
/// them. A texel of which nothing is covered is the plain mean, of weight 0; the weight of any other is the mean of
/// weights.
class MipChain {
 public:
  /// Row y of a level, from 1 on: width x channels samples and width weights. Rows of each level come from its first
  /// on.
  using Sink = std::function<void(int level, int y, std::span<const float> texels, std::span<const float> weights)>;

  /// channels  1 to 4
  /// levels    of the texture, level 0 included; 1 to mostLevels(width, height)
  MipChain(int width, int height, int channels, int levels, Sink sink);

  /// The next rows of level 0.
  /// texels   rows x width x channels
  /// weights  rows x width; empty: 1 everywhere
  void push(std::span<const float> texels, std::span<const float> weights = {});

 private:
  /// What one row adds up to: weight, weighted samples and plain samples of each texel.
  struct Sums {
    std::vector<float> weights, weighted, plain;
    void clear(std::size_t width, std::size_t channels);
    void add(float share, const Sums& row);
  };
  /// From one level to the next.
  struct Step {
    int width, height;  // of the level that comes in
    int next_row;       // to come in
    Sums across;        // the row that came in, halved
    Sums down;          // what rows so far are of the next row to go out
  };

  void take(std::size_t step, std::span<const float> texels, std::span<const float> weights);
  void halveRow(Step& step, std::span<const float> texels, std::span<const float> weights) const;
  void emit(std::size_t step, int y);

  int width_;
  std::size_t channels_;
  Sink sink_;
  std::vector<Step> steps_;
  std::vector<float> ones_;
};

}  // namespace facezip::blocks
