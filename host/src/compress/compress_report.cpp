#include "compress/compress_report.hpp"

#include <cmath>

namespace facezip::compress {
namespace {

/// Covered texels times channels: what a mean over an expression's samples divides by.
double coveredSamples(const CompressionJob& job, std::size_t m) {
  return static_cast<double>(job.grams.covered_texels[m]) * job.maps.maps[m].samples->shape().channels;
}

double rmseOf(const CompressionJob& job, std::size_t m, double squared_error) {
  return std::sqrt(squared_error / (coveredSamples(job, m) * job.maps.maps[m].samples->expressions()));
}

void reportMasks(const FaceMasks& masks, const GramSlots& slots, CompressReport& report) {
  report.masks = masks.masks.mask_count;
  report.mask_radius = masks.samples.radius;
  report.unit = masks.unit ? geometry::unitSymbol(*masks.unit) : "";
  report.unit_guessed = masks.unit_guessed;
  report.cut_mass_mean = masks.masks.cost.mean_removed;
  report.cut_mass_max = masks.masks.cost.largest_removed;
  report.active_masks_mean = masks.masks.cost.mean_active_after;
  report.overlapping_pairs = static_cast<int>(slots.pairs.size());
}

void reportPermutation(const PermutationRecord& record, CompressReport& report) {
  report.permutation_cost = record.cost;
  report.permutation_solver = record.solver;
  report.permutation_bound = record.bound;
  report.permutation_bounds = record.bounds;
  report.permutation_cost_median = record.median_restart_cost;
  report.restart_costs = record.restart_costs;
  report.convergence = record.convergence;
}

}  // namespace

CompressReport makeReport(const CompressionJob& job, const OpenTextures& textures, const GramSlots& slots,
                          const RateSearch* rates, const Attempt& attempt) {
  CompressReport report;
  report.device = job.run.context.info().name;
  report.differences = attempt.form.differences;
  report.weight_scale = attempt.form.weight_scale;
  report.weight_sets = attempt.form.weights_per_map ? static_cast<int>(job.maps.maps.size()) : 1;
  report.feather = job.maps.maps[job.maps.reference].raster->feather();
  report.covered_texels = job.grams.covered_texels.front();
  reportMasks(job.model.masks, slots, report);
  reportPermutation(attempt.permutation, report);
  if (rates != nullptr) {
    report.rate = rates->tried();
    report.rate_curve = rates->curve();
  }
  for (std::size_t m = 0; m < attempt.errors.size(); ++m) {
    if (!attempt.errors[m]) continue;
    report.rmse.emplace_back(job.maps.maps[m].source->name, rmseOf(job, m, *attempt.errors[m]));
  }
  if (report.rmse.size() == attempt.errors.size()) report.pooled_rmse = pooledRmse(job, attempt);
  report.refinement_errors = attempt.sweep_errors;
  report.band_rows = attempt.band_rows;
  report.decoded = textures.decoded;
  for (const OpenMap& map : textures.maps.maps) {
    report.wait_seconds += map.samples->waitSeconds();
    report.decode_seconds += map.samples->decodeSeconds();
  }
  return report;
}

double pooledRmse(const CompressionJob& job, const Attempt& attempt) {
  double error = 0.0;
  double samples = 0.0;
  for (std::size_t m = 0; m < attempt.errors.size(); ++m) {
    const double weight = job.maps.maps[m].metric_weight * coveredSamples(job, m);
    const double rmse = rmseOf(job, m, *attempt.errors[m]);
    error += weight * rmse * rmse;
    samples += weight;
  }
  return std::sqrt(error / samples);
}

}  // namespace facezip::compress
