#include "tables.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "option_types.hpp"

namespace facezip::cli {
namespace {

void printSeconds(const std::vector<std::pair<std::string, double>>& seconds) {
  double total = 0.0;
  for (const auto& [stage, time] : seconds) total += time;
  fmt::print("{:<34}{:>10}\n", "stage", "seconds");
  for (const auto& [stage, time] : seconds) fmt::print("{:<34}{:>10.2f}\n", stage, time);
  fmt::print("{:<34}{:>10.2f}\n", "total", total);
}

/// Column heading of a method, in the order the tables show them.
const std::vector<std::pair<std::string, std::string>>& methodTitles() {
  static const std::vector<std::pair<std::string, std::string>> titles = {
      {"package", "package"}, {"no_permutation", "not permuted"}, {"pca4", "PCA(4)"}, {"pca8", "PCA(8)"}};
  return titles;
}

void printErrors(const Evaluation::Map& map, const std::vector<std::string>& expressions) {
  fmt::print("\n{}: RMSE over the covered texels, 0..255 (difference to the neutral: {:.3f})\n{:<34}", map.name,
             map.rms_difference, "expression");
  for (const auto& [key, title] : methodTitles()) {
    if (map.rmse.contains(key)) fmt::print("{:>14}", title);
  }
  const auto row = [&](const std::string& name, auto&& value) {
    fmt::print("\n{:<34}", name);
    for (const auto& [key, title] : methodTitles()) {
      if (map.rmse.contains(key)) fmt::print("{:>14.3f}", value(map.rmse.at(key)));
    }
  };
  for (std::size_t n = 0; n < expressions.size(); ++n) {
    row(expressions[n], [n](const MapErrors& errors) { return errors.per_expression[n]; });
  }
  row("all", [](const MapErrors& errors) { return errors.pooled; });
  fmt::print("\n");
}

void printBytes(const Evaluation& evaluation) {
  static const std::vector<std::pair<std::string, std::string>> rows = {{"package", "package"},
                                                                        {"pca4", "PCA(4)"},
                                                                        {"pca8", "PCA(8)"},
                                                                        {"raw", "all textures"},
                                                                        {"package_disk", "package, files on disk"}};
  fmt::print("\n{:<34}{:>14}\n", "run-time memory", "");
  for (const auto& [key, title] : rows) {
    const auto found = evaluation.bytes.find(key);
    if (found != evaluation.bytes.end()) fmt::print("{:<34}{:>14}\n", title, formatMegabytes(found->second));
  }
}

void printPermutation(const CompressReport& report) {
  if (!report.permutation_bound) {
    fmt::print("permutation cost {:.4g} (not permuted)\n", report.permutation_cost);
    return;
  }
  fmt::print("permutation cost {:.4g}, lower bound {:.4g}, gap {:.2f} %", report.permutation_cost,
             *report.permutation_bound, 100.0 * report.permutationGap());
  if (!report.restart_costs.empty()) {
    fmt::print("; median of {} restarts {:.4g}", report.restart_costs.size(), report.permutation_cost_median);
  }
  fmt::print("\n");
}

}  // namespace

void printCompressReport(const CompressReport& report) {
  fmt::print("{} masks, {} overlapping pairs, {} covered texels\n", report.masks, report.overlapping_pairs,
             report.covered_texels);
  fmt::print("mask tails cut: {:.2f} % of a vertex's weight on average, {:.1f} % at most; {:.1f} masks at a vertex\n",
             100.0 * report.cut_mass_mean, 100.0 * report.cut_mass_max, report.active_masks_mean);
  printPermutation(report);
  if (report.refinement_errors.size() > 1 && report.refinement_errors.front() > 0.0) {
    fmt::print("refining: squared error");
    for (const double error : report.refinement_errors) {
      fmt::print(" {:.1f} %", 100.0 * error / report.refinement_errors.front());
    }
    fmt::print("\n");
  }
  for (const auto& [map, rmse] : report.rmse) fmt::print("{}: RMSE {:.3f} (0..255)\n", map, rmse);
  fmt::print("package on disk {}, peak memory {}\n\n", formatMegabytes(report.package_disk_bytes),
             formatMegabytes(report.peak_memory_bytes));
  printSeconds(report.seconds);
  fmt::print("{:<34}{:>10.2f}\n", "  of it waiting for textures", report.wait_seconds);
  fmt::print("{:<34}{:>10.2f}\n", "  decoding, beside the work", report.decode_seconds);
}

void printEvaluation(const Evaluation& evaluation) {
  for (const Evaluation::Map& map : evaluation.maps) printErrors(map, evaluation.expressions);
  printBytes(evaluation);
  fmt::print("\n");
  printSeconds(evaluation.seconds);
}

}  // namespace facezip::cli
