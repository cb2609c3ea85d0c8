#include "facezip/report.hpp"

#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "io/staged_directory.hpp"

namespace facezip {
namespace {
using nlohmann::json;

constexpr int kReportVersion = 1;

json secondsJson(const std::vector<std::pair<std::string, double>>& seconds) {
  json object = json::object();
  double total = 0.0;
  for (const auto& [stage, time] : seconds) {
    object[stage] = time;
    total += time;
  }
  object["total"] = total;
  return object;
}

json permutationJson(const CompressReport& report) {
  json object = {{"cost", report.permutation_cost},
                 {"median_cost", report.permutation_cost_median},
                 {"restart_costs", report.restart_costs},
                 {"convergence", report.convergence}};
  if (report.permutation_bound) {
    object["solver"] = report.permutation_solver;
    object["bound"] = *report.permutation_bound;
    object["gap"] = report.permutationGap();
    object["bound_convergence"] = report.permutation_bounds;
  }
  return object;
}

}  // namespace

std::string toJson(const CompressReport& report) {
  json object = {
      {"facezip_report", "compress"},
      {"version", kReportVersion},
      {"device", report.device},
      {"masks", report.masks},
      {"mask_radius", report.mask_radius},
      {"unit", report.unit},
      {"unit_guessed", report.unit_guessed},
      {"covered_texels", report.covered_texels},
      {"mask_cut",
       {{"mean", report.cut_mass_mean}, {"max", report.cut_mass_max}, {"active_masks", report.active_masks_mean}}},
      {"overlapping_pairs", report.overlapping_pairs},
      {"permutation", permutationJson(report)},
      {"rmse", json::object()},
      {"refinement", {{"squared_errors", report.refinement_errors}}},
      {"band_rows", report.band_rows},
      {"later_passes", report.decoded},
      {"bytes", {{"package_disk", report.package_disk_bytes}, {"peak_memory", report.peak_memory_bytes}}},
      {"seconds", secondsJson(report.seconds)}};
  for (const auto& [map, rmse] : report.rmse) object["rmse"][map] = rmse;
  object["seconds"]["waiting for textures"] = report.wait_seconds;
  object["seconds"]["decoding textures"] = report.decode_seconds;
  return object.dump(2) + "\n";
}

std::string toJson(const Evaluation& evaluation) {
  json object = {{"facezip_report", "evaluate"},
                 {"version", kReportVersion},
                 {"expressions", evaluation.expressions},
                 {"covered_texels", evaluation.covered_texels},
                 {"maps", json::object()},
                 {"bytes", evaluation.bytes},
                 {"seconds", secondsJson(evaluation.seconds)}};
  for (const Evaluation::Map& map : evaluation.maps) {
    json entry = {{"rms_difference", map.rms_difference}, {"rmse", json::object()}, {"per_expression", json::object()}};
    for (const auto& [method, errors] : map.rmse) {
      entry["rmse"][method] = errors.pooled;
      for (std::size_t n = 0; n < evaluation.expressions.size(); ++n) {
        entry["per_expression"][evaluation.expressions[n]][method] = errors.per_expression[n];
      }
    }
    object["maps"][map.name] = std::move(entry);
  }
  return object.dump(2) + "\n";
}

void writeReport(const std::filesystem::path& file, const std::string& json_text) {
  if (file.has_parent_path()) io::createDirectories(file.parent_path());
  io::writeTextFileAtomically(file, json_text);
}

}  // namespace facezip
