#include "compress/fit_choice.hpp"

#include "refine/refinement.hpp"

namespace facezip::compress {
namespace {

/// Share of the start's error beyond which refined weights may be worse than the start; they commonly leave a third.
constexpr double kSuspicious = 0.5;
/// The same of an estimate, which may be off by a fifth.
constexpr double kWorthMeasuring = 0.4;

/// What rounding weights to bytes adds to the squared error of one map, when its textures are spread evenly over their
/// ranges: more than it mostly is.
double weightRounding(const FittedWeights& fitted, std::size_t m, int channels, double samples) {
  double error = 0.0;
  const std::vector<TextureRange>& ranges = fitted.ranges[m];
  for (std::size_t plane = 0; plane < ranges.size(); ++plane) {
    const double step = fitted.weights.scale[plane / static_cast<std::size_t>(channels)];
    const double reach = static_cast<double>(ranges[plane].max) - static_cast<double>(ranges[plane].min);
    error += step * step / 12.0 * reach * reach / 12.0;
  }
  return error * samples;
}

/// Squared error of what would be written, fit weights in it, without looking at a texel.
double estimateWritten(const FitProblem& problem, const PackageForm& form, const FittedWeights& fitted,
                       const CoveredFace& face) {
  const std::vector<MapCodes> codes = codesOf(form, problem.space, problem.maps, fitted, face);
  const std::vector<double> weight_squares = meanSquares(fitted.weights, problem.space, face.cells);
  double error = 0.0;
  for (std::size_t m = 0; m < problem.maps.size(); ++m) {
    const GridMap& map = problem.maps[m];
    const double samples = static_cast<double>(face.texels[map.index]) * problem.space.expressions;
    const double narrow = codeSquaredError(fitted.ranges[m], weight_squares) * samples;
    const int channels = map.map->samples->shape().channels;
    error += map.fit_weight *
             (fitted.errors[m] + (codes[m].bits == 8 ? narrow : 0.0) + weightRounding(fitted, m, channels, samples));
  }
  return error;
}

}  // namespace

FittedWeights chooseFit(const FitProblem& problem, const PackageForm& form, const CoveredFace& face, int band_rows,
                        const device::Run& run) {
  // As many textures as expressions: the start is exact already.
  const bool exact = problem.space.expressions <= problem.space.textures;
  FittedWeights refined = fitWeights(problem, exact ? 0 : RefinementOptions{}.most_sweeps, run);
  if (exact) {
    refined.sweep_errors.clear();  // nothing was refined
    return refined;
  }
  const double start_error = refined.sweep_errors.front();
  if (estimateWritten(problem, form, refined, face) <= kWorthMeasuring * start_error) return refined;
  const auto written = [&](const FittedWeights& fitted) {
    return writtenError(form, problem.space, problem.maps, fitted, face, band_rows, run);
  };
  const double refined_error = written(refined);
  if (refined_error <= kSuspicious * start_error) return refined;
  FittedWeights start = fitWeights(problem, 0, run);
  if (written(start) > refined_error) return refined;
  run.progress.note("the paper's weights are exact here: they are kept");
  start.sweep_errors = refined.sweep_errors;  // what was tried
  return start;
}

}  // namespace facezip::compress
