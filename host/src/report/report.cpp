#include "facezip/report.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "io/staged_directory.hpp"
#include "rig/rig_json.hpp"

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

json formatJson(const std::optional<BlockFormat>& format) {
  return format ? json(std::string(blockFormatName(*format))) : json(nullptr);
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

json toJson(const TexelErrors& errors) {
  // An exact result has no finite PSNR; JSON has no infinity.
  const json psnr = std::isfinite(errors.psnr) ? json(errors.psnr) : json(nullptr);
  json beyond = json::object();
  for (std::size_t i = 0; i < errors.beyond.size(); ++i) {
    beyond[std::to_string(TexelErrors::kNoticed[i])] = errors.beyond[i];
  }
  return {{"rmse", errors.rmse}, {"psnr", psnr}, {"p99", errors.p99}, {"max", errors.max}, {"beyond", beyond}};
}

json toJson(const NormalAngles& angles) { return {{"mean", angles.mean}, {"p99", angles.p99}, {"max", angles.max}}; }

void addErrors(const Evaluation::Map& map, const std::vector<std::string>& expressions, json& entry) {
  entry["rmse"] = json::object();
  entry["per_expression"] = json::object();
  for (const auto& [method, errors] : map.rmse) {
    entry["rmse"][method] = errors.pooled;
    for (std::size_t n = 0; n < errors.per_expression.size(); ++n) {
      entry["per_expression"][expressions[n]][method] = errors.per_expression[n];
    }
  }
}

/// Writes errors of all expressions to entry[pooled][METHOD] and of each to entry[each][NAME][METHOD].
template <typename Value>
void addPooledAndEach(const std::map<std::string, PooledAndEach<Value>>& methods,
                      const std::vector<std::string>& expressions, const char* pooled, const char* each, json& entry) {
  for (const auto& [method, values] : methods) {
    entry[pooled][method] = toJson(values.pooled);
    for (std::size_t n = 0; n < values.per_expression.size(); ++n) {
      entry[each][expressions[n]][method] = toJson(values.per_expression[n]);
    }
  }
}

void addAblation(const Evaluation::Map& map, const Evaluation& evaluation, json& entry) {
  for (const auto& [method, by_differences] : map.ablation) {
    for (const auto& [differences, rmse] : by_differences) {
      entry["ablation"][method][std::to_string(differences)] = {
          {"rmse", rmse}, {"bytes", evaluation.ablation_bytes.at(method).at(differences)}};
    }
  }
}

json mapJson(const Evaluation::Map& map, const Evaluation& evaluation) {
  json entry = {{"rms_difference", map.rms_difference}};
  addErrors(map, evaluation.expressions, entry);
  addPooledAndEach(map.detail, evaluation.expressions, "detail_pooled", "detail", entry);
  addPooledAndEach(map.angles, evaluation.expressions, "angle", "angle_per_expression", entry);
  for (const auto& [method, errors] : map.blends) {
    entry["blends"][method] = {{"rmse", errors.rmse}, {"largest_share_of_bound", errors.largest_share_of_bound}};
  }
  addAblation(map, evaluation, entry);
  return entry;
}

/// A weight vector by name, without the expressions at 0.
json weightsJson(const std::vector<float>& weights, const std::vector<std::string>& expressions) {
  json object = json::object();
  for (std::size_t n = 0; n < weights.size(); ++n) {
    if (weights[n] != 0.0f) object[expressions[n]] = weights[n];
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
      {"differences", report.differences},
      {"weight_scale", report.weight_scale},
      {"weight_sets", report.weight_sets},
      {"border", {{"step", report.border_step}, {"feather", report.feather}}},
      {"rate_curve", json::array()},
      {"rmse", json::object()},
      {"refinement", {{"squared_errors", report.refinement_errors}}},
      {"band_rows", report.band_rows},
      {"later_passes", report.decoded},
      {"bytes", {{"package_disk", report.package_disk_bytes}, {"peak_memory", report.peak_memory_bytes}}},
      {"seconds", secondsJson(report.seconds)}};
  for (const RatePoint& point : report.rate_curve) {
    object["rate_curve"].push_back({{"differences", point.differences},
                                    {"weight_scale", point.weight_scale},
                                    {"weights_per_map", point.weights_per_map},
                                    {"code_bits", point.code_bits},
                                    {"texture_format", formatJson(point.texture_format)},
                                    {"difference_format", formatJson(point.difference_format)},
                                    {"bytes", point.bytes},
                                    {"rmse", point.rmse}});
  }
  for (const auto& [map, rmse] : report.rmse) object["rmse"][map] = rmse;
  if (report.pooled_rmse) object["pooled_rmse"] = *report.pooled_rmse;
  object["seconds"]["waiting for textures"] = report.wait_seconds;
  object["seconds"]["decoding textures"] = report.decode_seconds;
  return object.dump(2) + "\n";
}

std::string toJson(const ConvertReport& report) {
  json object = {{"facezip_report", "convert"},
                 {"version", kReportVersion},
                 {"device", report.device},
                 {"maps", json::object()},
                 {"bytes",
                  {{"memory", {{"before", report.memory_before}, {"after", report.memory_after}}},
                   {"package_disk", {{"before", report.disk_before}, {"after", report.disk_after}}}}},
                 {"seconds", secondsJson(report.seconds)}};
  for (const ConvertReport::Map& map : report.maps) {
    object["maps"][map.name] = {{"texture_format", formatJson(map.texture_format)},
                                {"difference_format", formatJson(map.difference_format)},
                                {"bytes", {{"before", map.bytes_before}, {"after", map.bytes_after}}},
                                {"rmse", map.rmse}};
  }
  return object.dump(2) + "\n";
}

std::string toJson(const Evaluation& evaluation) {
  json object = {{"facezip_report", "evaluate"},
                 {"version", kReportVersion},
                 {"method", evaluation.method},
                 {"differences", evaluation.differences},
                 {"expressions", evaluation.expressions},
                 {"covered_texels", evaluation.covered_texels},
                 {"maps", json::object()},
                 {"bytes", evaluation.bytes},
                 {"blend_weights", json::array()},
                 {"seconds", secondsJson(evaluation.seconds)}};
  for (const MaskSweepPoint& point : evaluation.mask_sweep) {
    object["mask_sweep"].push_back({{"masks", point.masks}, {"rmse", point.rmse}});
  }
  for (const Evaluation::Map& map : evaluation.maps) object["maps"][map.name] = mapJson(map, evaluation);
  for (const std::vector<float>& weights : evaluation.blend_weights) {
    object["blend_weights"].push_back(weightsJson(weights, evaluation.expressions));
  }
  return object.dump(2) + "\n";
}

std::string toJson(const RegistrationReport& report) {
  json object = {{"facezip_report", "register"},
                 {"version", kReportVersion},
                 {"unit", report.unit},
                 {"unit_guessed", report.unit_guessed},
                 {"template_scale", report.template_scale},
                 {"vertices", report.vertices},
                 {"region_triangles", report.region_triangles},
                 {"flow_side", report.flow_side},
                 {"scans", json::array()},
                 {"seconds", secondsJson(report.seconds)}};
  for (const RegisteredScan& scan : report.scans) {
    object["scans"].push_back({{"name", scan.name},
                               {"triangles", scan.triangles},
                               {"spikes", scan.spikes},
                               {"roughness_mm", scan.roughness},
                               {"landmarks", {{"used", scan.landmarks}, {"rms_mm", scan.landmark_rms}}},
                               {"model_mm", {{"mean", scan.model_mean}, {"p99", scan.model_p99}}},
                               {"residual_mm", {{"mean", scan.mean}, {"p99", scan.p99}}},
                               {"matched", scan.matched},
                               {"coverage", scan.coverage},
                               {"flow_texels",
                                {{"rounds", scan.flow_rounds},
                                 {"before", {{"mean", scan.flow_before_mean}, {"p95", scan.flow_before_p95}}},
                                 {"after", {{"mean", scan.flow_mean}, {"p95", scan.flow_p95}}},
                                 {"trusted", scan.flow_trusted}}},
                               {"colour_gain", scan.colour_gain},
                               {"head_motion", {{"degrees", scan.degrees}, {"mm", scan.millimetres}}}});
  }
  return object.dump(2) + "\n";
}

std::string toJson(const AlignmentReport& report) {
  json object = {
      {"facezip_report", "align"},       {"version", kReportVersion},    {"map", report.map},
      {"flow_width", report.flow_width}, {"expressions", json::array()}, {"seconds", secondsJson(report.seconds)}};
  for (const AlignedExpression& expression : report.expressions) {
    object["expressions"].push_back({{"name", expression.name},
                                     {"moved", expression.moved},
                                     {"flow_texels",
                                      {{"rounds", expression.rounds},
                                       {"before", {{"mean", expression.before_mean}, {"p95", expression.before_p95}}},
                                       {"after", {{"mean", expression.after_mean}, {"p95", expression.after_p95}}},
                                       {"trusted", expression.trusted},
                                       {"largest", expression.largest}}}});
  }
  return object.dump(2) + "\n";
}

std::string toJson(const RigReport& report) {
  json object = json::parse(rig::rigJson(report, 1.0));
  for (const char* of_the_file : {"format", "generator", "millimetres_per_unit"}) object.erase(of_the_file);
  object["facezip_report"] = "rig";
  object["version"] = kReportVersion;
  object["vertices"] = report.vertices;
  object["parts"] = report.parts;
  object["compress"] = json::parse(toJson(report.compress));
  object["seconds"] = secondsJson(report.seconds);
  return object.dump(2) + "\n";
}

std::string toJson(const SolvedClip& clip) {
  json object = {{"facezip_report", "solve-weights"},
                 {"version", kReportVersion},
                 {"shapes", clip.shapes},
                 {"residual_mm", json::array()},
                 {"seconds", {{"total", clip.seconds}}}};
  for (const RigResidual& residual : clip.residuals) {
    object["residual_mm"].push_back(
        {{"mean", residual.mean}, {"p99", residual.percentile_99}, {"max", residual.largest}});
  }
  return object.dump(2) + "\n";
}

std::string toJson(const TrainReport& report) {
  json object = {{"facezip_report", "train"},
                 {"version", kReportVersion},
                 {"subjects", report.subjects},
                 {"expressions", report.expressions},
                 {"shapes", report.shapes},
                 {"skin_vertices", report.skin_vertices},
                 {"regression",
                  {{"components", report.components},
                   {"softness", report.softness},
                   {"shared", report.shared},
                   {"noise", report.noise},
                   {"left_out_mm", report.left_out_mm},
                   {"template_mm", report.template_mm}}},
                 {"textures", json::array()},
                 {"model_bytes", report.model_bytes},
                 {"seconds", secondsJson(report.seconds)}};
  for (const LearnedTexture& texture : report.textures) {
    object["textures"].push_back(
        {{"map", texture.map}, {"error_percent", texture.error}, {"no_change_percent", texture.nothing}});
  }
  return object.dump(2) + "\n";
}

std::string toJson(const GenerateReport& report) {
  json object = json::parse(toJson(report.rig));
  object["facezip_report"] = "generate";
  object["strangeness"] = report.strangeness;
  object["maps"] = report.maps;
  object["left_alone"] = report.left_alone;
  return object.dump(2) + "\n";
}

void requireReportPlace(const std::filesystem::path& file, const ProtectedPaths& taken, const std::string& option) {
  namespace fs = std::filesystem;
  if (file.empty()) return;
  taken.requireApart(file, option);
  const std::string cure = "choose another " + option;
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  if (fs::is_directory(status)) throw OutputError(file, "a directory is in the way", cure);
  if (!fs::status_known(status)) throw OutputError(file, error.message(), cure);
  if (fs::exists(status) && !fs::is_regular_file(status)) return;  // /dev/stdout, a pipe
  fs::path folder = fs::absolute(file).parent_path();
  while (!fs::exists(folder, error) && folder.has_relative_path()) folder = folder.parent_path();
  if (::access((folder / ".").c_str(), W_OK | X_OK) == 0) return;
  throw OutputError(file, fmt::format("{}: {}", folder.string(), std::strerror(errno)), cure);
}

void writeReport(const std::filesystem::path& file, const std::string& json_text, Progress* progress) {
  if (file.has_parent_path()) io::createDirectories(file.parent_path());
  io::writeTextFileAtomically(file, json_text, progress);
}

}  // namespace facezip
