// rate_choice.hpp - how many difference textures, and weights how fine, for an error or a size that was asked for.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "facezip/compress.hpp"

namespace facezip::compress {

/// Blocks of the maps of 8 bits; none: images.
struct RateFormats {
  std::optional<BlockFormat> neutral;
  std::optional<BlockFormat> differences;
};

/// What the estimate needs of a map.
struct RateMap {
  int width = 0;  ///< texels
  int height = 0;
  int channels = 1;
  int sample_bytes = 1;  ///< of the neutral; above 1, difference textures may have codes of 16 bits, and no blocks
  double metric_weight = 1.0;
  double covered_samples = 0.0;  ///< covered texels x channels x expressions
  double mean_square = 0.0;      ///< of the differences, per covered sample, (1/255)^2
  /// [scale][C]: share of that energy which the best C components of every cell's texels leave, C = 0 to 8
  std::vector<std::vector<double>> left;
};

/// What coding one difference texture in blocks adds to the squared error, as a share of the differences' own mean
/// square. It falls with the bits that a texel has.
double codingNoise(BlockFormat format);

/// Codes of 8 bits add this share of the differences' mean square, those of 16 that / 257^2.
inline constexpr double kRounding = 1.5e-3;

/// The maps' size and estimated error for every number of textures 1 to 8, every weight scale and all formats, and with
/// codes of 16 bits too where there are maps that may have them.
///   RMSE^2 = metric-weighted mean over maps of mean_square (left + rounding + C coding noise)
/// Free weights come near what the best C components of each cell leave, more often below than above it since they are
/// interpolated; maps that share weights leave what C components for all of them do. What coding the neutral adds is
/// left out: the differences are to what it decodes to, and take it up.
/// scales        texels of the largest map per cell, as RateMap::left counts them
/// cells         of the weight grid at each scale, times the number of weight sets
/// weight_maps   of each set: N, a rig's M shapes beside them
/// shared_left   [scale][C] where all maps share weights: as RateMap::left, of their weighted energy together, and in
///               its place; empty where each has its own
std::vector<RatePoint> rateCurve(std::span<const RateMap> maps, std::span<const int> scales,
                                 std::span<const std::uint64_t> cells, int weight_maps,
                                 std::span<const RateFormats> formats,
                                 const std::vector<std::vector<double>>& shared_left = {});

/// The points that no other beats in both size and error, rising by size.
std::vector<RatePoint> efficientPoints(std::vector<RatePoint> curve);

/// True if a set of weights for every map errs no more, for its bytes, than packages that share one: their error at
/// these bytes is that between one number of difference textures and the next, log RMSE growing evenly with bytes.
/// curve  points of both kinds that are alike but for the number of textures
/// differences  C of the package that is to be
bool ownWeightsPay(std::span<const RatePoint> curve, int differences);

/// The smallest point whose error times `calibration` is at most `target`, and within `budget` bytes; without a target
/// the best within the budget; nothing if there is none.
std::optional<RatePoint> chooseRate(std::span<const RatePoint> efficient, std::optional<double> target,
                                    std::optional<std::uint64_t> budget, double calibration);

}  // namespace facezip::compress
