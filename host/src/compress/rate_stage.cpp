#include "compress/rate_stage.hpp"

#include <fmt/format.h>

#include <cmath>

#include "facezip/device.hpp"
#include "facezip/error.hpp"

namespace facezip::compress {
namespace {

bool fitsMemory(const CompressionState& state) {
  try {
    state.plannedBandRows();
    for (const WeightGroup& group : state.groups) state.plannedWindowRows(group);
    return true;
  } catch (const InputError&) {
    return false;
  } catch (const DeviceError&) {
    return false;
  }
}

/// RMSE of all maps as written, metric weights in it.
double pooledRmse(const CompressionState& state) {
  double error = 0.0;
  double samples = 0.0;
  for (std::size_t m = 0; m < state.maps.maps.size(); ++m) {
    const OpenMap& map = state.maps.maps[m];
    const double weight = map.metric_weight * state.coveredTexels(map) * map.samples->shape().channels;
    error += weight * state.report.rmse[m].second * state.report.rmse[m].second;
    samples += weight;
  }
  return std::sqrt(error / samples);
}

}  // namespace

void takeRate(CompressionState& state, const RatePoint& point) {
  state.options.differences = point.differences;
  state.options.weight_scale = point.weight_scale;
  assignWeightScales(state.maps, point.weight_scale);
}

void chooseRate(CompressionState& state) {
  const RatePoint chosen = state.rates->choose([&state](const RatePoint& point) {
    takeRate(state, point);
    return fitsMemory(state);
  });
  takeRate(state, chosen);
  state.report.rate = chosen;
  state.report.rate_curve = state.rates->curve();
  state.report.band_rows = state.plannedBandRows();
}

bool missesTarget(CompressionState& state) {
  if (!state.rates) return false;
  const double reached = pooledRmse(state);
  if (!state.rates->misses(reached)) return false;
  state.progress.note(fmt::format("{} differences with weights at 1/{} reach {:.3f}, not {:.3f}: trying more",
                                  state.options.differences, state.options.weight_scale, reached,
                                  *state.options.target_rmse));
  return true;
}

}  // namespace facezip::compress
