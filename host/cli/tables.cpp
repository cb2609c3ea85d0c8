#include "tables.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>

#include "option_types.hpp"
#include "terminal.hpp"

namespace facezip::cli {
namespace {

void printSeconds(const std::vector<std::pair<std::string, double>>& seconds) {
  double total = 0.0;
  for (const auto& [stage, time] : seconds) total += time;
  say("{:<34}{:>10}\n", "stage", "seconds");
  for (const auto& [stage, time] : seconds) say("{:<34}{:>10.2f}\n", stage, time);
  say("{:<34}{:>10.2f}\n", "total", total);
}

/// Methods that have a column of their own: the package's own method is the package.
std::vector<std::string> columnsOf(const Evaluation& evaluation, const Evaluation::Map& map) {
  std::vector<std::string> columns;
  for (const auto& [key, title] : evaluationTitles()) {
    if (map.rmse.contains(key) && key != evaluation.method) columns.push_back(key);
  }
  return columns;
}

void printErrors(const Evaluation& evaluation, const Evaluation::Map& map) {
  say("\n{}: RMSE over the covered texels, 0..255 (difference to the neutral: {:.3f})\n{:<34}", map.name,
      map.rms_difference, "expression");
  const std::vector<std::string> columns = columnsOf(evaluation, map);
  for (const std::string& key : columns) say("{:>14}", evaluationTitle(key));
  for (std::size_t n = 0; n < evaluation.expressions.size(); ++n) {
    say("\n{:<34}", evaluation.expressions[n]);
    for (const std::string& key : columns) {
      const std::vector<double>& each = map.rmse.at(key).per_expression;
      say("{:>14}", each.empty() ? "-" : fmt::format("{:.3f}", each[n]));
    }
  }
  say("\n{:<34}", "all");
  for (const std::string& key : columns) say("{:>14.3f}", map.rmse.at(key).pooled);
  say("\n");
}

void printTexelErrors(const std::string& name, const TexelErrors& errors) {
  say("{:<34}{:>14.2f}{:>14.2f}{:>14.2f}{:>10}{:>8}{:>8}\n", name, errors.psnr, errors.p99, errors.max,
      errors.beyond[0], errors.beyond[1], errors.beyond[2]);
}

void printDetail(const Evaluation& evaluation, const Evaluation::Map& map) {
  say("\n{:<34}{:>14}{:>14}{:>14}{:>10}{:>8}{:>8}\n", map.name + ": texels of the package", "PSNR dB", "99th pct",
      "largest", ">= 8", ">= 16", ">= 32");
  const auto& package = map.detail.at("package");
  for (std::size_t n = 0; n < evaluation.expressions.size(); ++n) {
    printTexelErrors(evaluation.expressions[n], package.per_expression[n]);
  }
  for (const std::string& key : columnsOf(evaluation, map)) {
    const auto found = map.detail.find(key);
    if (found != map.detail.end()) printTexelErrors("all, " + evaluationTitle(key), found->second.pooled);
  }
}

void printAngles(const Evaluation& evaluation, const Evaluation::Map& map) {
  if (map.angles.empty()) return;
  say("\n{:<34}{:>14}{:>14}{:>14}\n", map.name + ": angle of normals, degrees", "mean", "99th pct", "largest");
  for (const std::string& key : columnsOf(evaluation, map)) {
    const auto found = map.angles.find(key);
    if (found == map.angles.end()) continue;
    const NormalAngles& angles = found->second.pooled;
    say("{:<34}{:>14.3f}{:>14.2f}{:>14.2f}\n", evaluationTitle(key), angles.mean, angles.p99, angles.max);
  }
}

void printBlends(const Evaluation& evaluation, const Evaluation::Map& map) {
  if (map.blends.empty()) return;
  say("\n{:<34}{:>14}{:>14}\n", fmt::format("{}: {} random blends", map.name, evaluation.blend_weights.size()), "RMSE",
      "of bound");
  for (const std::string& key : columnsOf(evaluation, map)) {
    const auto found = map.blends.find(key);
    if (found == map.blends.end()) continue;
    say("{:<34}{:>14.3f}{:>12.0f} %\n", evaluationTitle(key), found->second.rmse,
        100.0 * found->second.largest_share_of_bound);
  }
}

constexpr int kAblatedDifferences[] = {1, 2, 3, 4, 8};

/// A row for each method and a column for each C; `cell` gives the text of a value.
template <typename Value, typename Cell>
void printAblation(const std::string& title, const std::map<std::string, std::map<int, Value>>& values,
                   const Cell& cell) {
  if (values.empty()) return;
  say("\n{:<34}", title);
  for (const int differences : kAblatedDifferences) say("{:>14}", fmt::format("C = {}", differences));
  for (const auto& [key, name] : evaluationTitles()) {
    const auto row = values.find(key);
    if (row == values.end()) continue;
    say("\n{:<34}", name);
    for (const int differences : kAblatedDifferences) {
      const auto value = row->second.find(differences);
      say("{:>14}", value == row->second.end() ? "" : cell(value->second));
    }
  }
  say("\n");
}

void printBytes(const Evaluation& evaluation) {
  std::vector<std::pair<std::string, std::string>> rows = evaluationTitles();
  rows.insert(rows.end(), {{"raw", "all textures"}, {"package_disk", "package, files on disk"}});
  say("\n{:<34}{:>14}\n", "run-time memory", "");
  for (const auto& [key, title] : rows) {
    const auto found = evaluation.bytes.find(key);
    if (found == evaluation.bytes.end() || key == evaluation.method) continue;
    say("{:<34}{:>14}\n", title, formatMegabytes(found->second));
  }
}

void printPermutation(const CompressReport& report) {
  if (!report.permutation_bound) {
    say("permutation cost {:.4g} (not permuted)\n", report.permutation_cost);
    return;
  }
  say("permutation cost {:.4g}, lower bound {:.4g}, gap {:.2f} %", report.permutation_cost, *report.permutation_bound,
      100.0 * report.permutationGap());
  if (!report.restart_costs.empty()) {
    say("; median of {} restarts {:.4g}", report.restart_costs.size(), report.permutation_cost_median);
  }
  say("\n");
}

/// What a target or budget was chosen from, and what was taken.
void printRateCurve(const CompressReport& report) {
  if (report.rate_curve.empty()) return;
  say("{:<14}{:<12}{:>12}{:>12}{:>16}\n", "differences", "format", "weights at", "memory", "expected RMSE");
  for (const RatePoint& point : report.rate_curve) {
    say("{:<14}{:<12}{:>12}{:>12}{:>16.3f}{}\n",
        fmt::format("{}{}", point.differences, point.code_bits == 16 ? ", 16-bit" : ""),
        point.difference_format ? blockFormatName(*point.difference_format) : "images",
        fmt::format("1/{}{}", point.weight_scale, point.weights_per_map ? " a map" : ""), formatMegabytes(point.bytes),
        point.rmse, point == report.rate ? "  <- taken" : "");
  }
  say("\n");
}

}  // namespace

void printCompressReport(const CompressReport& report) {
  printRateCurve(report);
  say("{} masks, {} overlapping pairs, {} covered texels\n", report.masks, report.overlapping_pairs,
      report.covered_texels);
  say("mask tails cut: {:.2f} % of a vertex's weight on average, {:.1f} % at most; {:.1f} masks at a vertex\n",
      100.0 * report.cut_mass_mean, 100.0 * report.cut_mass_max, report.active_masks_mean);
  say("textures {}, in bands of {} rows\n",
      report.decoded == "scratch file" ? "decoded once, into a scratch file" : "decoded again in every pass",
      report.band_rows);
  printPermutation(report);
  if (report.refinement_errors.size() > 1 && report.refinement_errors.front() > 0.0) {
    say("refining: squared error");
    for (const double error : report.refinement_errors) {
      say(" {:.1f} %", 100.0 * error / report.refinement_errors.front());
    }
    say("\n");
  }
  for (const auto& [map, rmse] : report.rmse) say("{}: RMSE {:.3f} (0..255)\n", map, rmse);
  if (report.pooled_rmse && (report.rmse.size() > 1 || report.rate)) {
    say("all maps: RMSE {:.3f}{}\n", *report.pooled_rmse,
        report.rate ? fmt::format(", expected were {:.3f}", report.rate->rmse) : "");
  }
  say("package on disk {}, peak memory {}\n\n", formatMegabytes(report.package_disk_bytes),
      formatMegabytes(report.peak_memory_bytes));
  printSeconds(report.seconds);
  say("{:<34}{:>10.2f}\n", "  of it waiting for textures", report.wait_seconds);
  say("{:<34}{:>10.2f}\n", "  decoding, beside the work", report.decode_seconds);
}

void printConvertReport(const ConvertReport& report) {
  say("{:<20}{:<28}{:>12}{:>12}{:>20}\n", "", "textures", "before", "now", "RMSE to before");
  for (const ConvertReport::Map& map : report.maps) {
    const auto name = [](const std::optional<BlockFormat>& format) {
      return std::string(format ? blockFormatName(*format) : "images");
    };
    std::string formats = name(map.texture_format);
    if (map.difference_format != map.texture_format) formats += ", differences " + name(map.difference_format);
    say("{:<20}{:<28}{:>12}{:>12}{:>20.3f}\n", map.name, formats, formatMegabytes(map.bytes_before),
        formatMegabytes(map.bytes_after), map.rmse);
  }
  say("{:<48}{:>12}{:>12}\n", "run-time memory, with weights", formatMegabytes(report.memory_before),
      formatMegabytes(report.memory_after));
  say("{:<48}{:>12}{:>12}\n\n", "package on disk", formatMegabytes(report.disk_before),
      formatMegabytes(report.disk_after));
  printSeconds(report.seconds);
}

void printEvaluation(const Evaluation& evaluation) {
  say("package: {} method, C = {}\n", evaluationTitle(evaluation.method), evaluation.differences);
  for (const Evaluation::Map& map : evaluation.maps) {
    printErrors(evaluation, map);
    printDetail(evaluation, map);
    printAngles(evaluation, map);
    printBlends(evaluation, map);
    printAblation(map.name + ": RMSE of all, by C", map.ablation,
                  [](double rmse) { return fmt::format("{:.3f}", rmse); });
  }
  printAblation("run-time memory, by C", evaluation.ablation_bytes, formatMegabytes);
  printBytes(evaluation);
  say("\n");
  printSeconds(evaluation.seconds);
}

namespace {

/// Of a rig that was fitted to expressions: how far it is from them.
void printRigFit(const RigReport& report) {
  say("\n{:<34}{:>22}{:>32}\n", "distance to the captured mesh, mm", "rig", "template alone");
  say("{:<34}{:>10}{:>10}{:>10}{:>12}{:>10}{:>10}\n", "expression", "mean", "99th pct", "largest", "mean", "99th pct",
      "largest");
  RigResidual mean, template_mean;
  const double share = 1.0 / static_cast<double>(report.expressions.size());
  const auto add = [share](RigResidual& sum, const RigResidual& each) {
    sum.mean += share * each.mean;
    sum.percentile_99 += share * each.percentile_99;
    sum.largest += share * each.largest;
  };
  const auto row = [](const std::string& name, const RigResidual& rig, const RigResidual& by_template) {
    say("{:<34}{:>10.3f}{:>10.3f}{:>10.3f}{:>12.3f}{:>10.3f}{:>10.3f}\n", name, rig.mean, rig.percentile_99,
        rig.largest, by_template.mean, by_template.percentile_99, by_template.largest);
  };
  for (std::size_t n = 0; n < report.expressions.size(); ++n) {
    row(report.expressions[n], report.residuals[n], report.template_residuals[n]);
    add(mean, report.residuals[n]);
    add(template_mean, report.template_residuals[n]);
  }
  row("mean", mean, template_mean);
  if (!report.head_motions.empty()) {
    RigHeadMotion most;
    for (const RigHeadMotion& motion : report.head_motions) {
      most = {std::max(most.degrees, motion.degrees), std::max(most.millimetres, motion.millimetres)};
    }
    say("head motion taken out: up to {:.2f} degrees, {:.2f} mm\n", most.degrees, most.millimetres);
  }
  say("rms over all, mm, after each iteration:");
  for (const double rms : report.convergence) say(" {:.3f}", rms);
  say("\ncloseness to the template {:g}: left-out expressions' gradients err {:.2f} of what the template errs",
      report.shape_prior, report.left_out_share);
  say("\n\ntextures of shapes: {}", report.texture_solve);
  if (report.texture_damping > 0.0) say(", lambda {:g}", report.texture_damping);
  if (report.left_out_nothing > 0.0) {
    say(", strain {:g}; expressions predicted from the others: RMSE {:.3f} (0..255) of {:.3f}", report.strain_share,
        report.left_out_rmse, report.left_out_nothing);
  }
  say("\n");
}

}  // namespace

void printRigReport(const RigReport& report) {
  say("{} shapes on {} vertices ({} of the skin), from {} expressions; transferred by {}\n", report.shapes.size(),
      report.vertices, report.skin_vertices, report.expressions.size(), report.transfer);
  if (!report.expressions.empty()) printRigFit(report);
  for (const auto& [map, rmse] : report.compress.rmse) say("{}: RMSE {:.3f} as compressed (0..255)\n", map, rmse);
  say("\n");
  printSeconds(report.seconds);
}

void printTrainReport(const TrainReport& report) {
  say("{} subjects, {} expressions, {} shapes on {} vertices\n", report.subjects, report.expressions.size(),
      report.shapes.size(), report.skin_vertices);
  say("expressions of subjects left out: {:.3f} mm by the template, {:.3f} mm predicted (rms; {} components, softness "
      "{:g}, shared {:g}, noise {:g})\n",
      report.template_mm, report.left_out_mm, report.components, report.softness, report.shared, report.noise);
  for (const LearnedTexture& texture : report.textures) {
    say("{}: changes of the library's textures err by {:.2f} % of the map's mean, without a model by {:.2f} %\n",
        texture.map, texture.error, texture.nothing);
  }
  say("model: {}\n\n", formatMegabytes(report.model_bytes));
  printSeconds(report.seconds);
}

void printGenerateReport(const GenerateReport& report) {
  say("{} shapes on {} vertices ({} of the skin)\n", report.rig.shapes.size(), report.rig.vertices,
      report.rig.skin_vertices);
  say("the neutral lies {:.2f} times as far from the model's mean as is usual\n", report.strangeness);
  if (!report.maps.empty()) say("textures of every shape: {}\n", fmt::join(report.maps, ", "));
  for (const auto& [map, rmse] : report.rig.compress.rmse) {
    say("{}: RMSE {:.3f} as compressed (0..255)\n", map, rmse);
  }
  say("\n");
  printSeconds(report.rig.seconds);
}

void printRegistrationReport(const RegistrationReport& report) {
  say("{} vertices, {} triangles of the region, in {}{}\n", report.vertices, report.region_triangles, report.unit,
      report.unit_guessed ? " (guessed)" : "");
  say("\n{:<34}{:>20}{:>20}{:>10}{:>20}{:>20}\n", "scan to mesh, mm", "posed", "registered", "shown", "head moved",
      "flow, texels");
  say("{:<34}{:>10}{:>10}{:>10}{:>10}{:>10}{:>10}{:>10}{:>10}{:>10}\n", "", "mean", "99th pct", "mean", "99th pct", "%",
      "degrees", "mm", "before", "after");
  for (const RegisteredScan& scan : report.scans) {
    say("{:<34}{:>10.3f}{:>10.3f}{:>10.3f}{:>10.3f}{:>10.1f}{:>10.2f}{:>10.2f}{:>10.2f}{:>10.2f}\n", scan.name,
        scan.model_mean, scan.model_p99, scan.mean, scan.p99, 100.0 * scan.coverage, scan.degrees, scan.millimetres,
        scan.flow_before_mean, scan.flow_mean);
  }
  say("\n");
  printSeconds(report.seconds);
}

void printAlignmentReport(const AlignmentReport& report) {
  say("flow of {} against the neutral's, in texels of a picture {} wide\n", report.map, report.flow_width);
  say("\n{:<34}{:>20}{:>20}{:>10}{:>10}{:>8}\n", "", "before", "after", "believed", "moved by", "rounds");
  say("{:<34}{:>10}{:>10}{:>10}{:>10}{:>10}{:>10}\n", "", "mean", "95th pct", "mean", "95th pct", "%", "at most");
  for (const AlignedExpression& expression : report.expressions) {
    say("{:<34}{:>10.2f}{:>10.2f}{:>10.2f}{:>10.2f}{:>10.1f}{:>10.2f}{:>8}\n", expression.name, expression.before_mean,
        expression.before_p95, expression.after_mean, expression.after_p95, 100.0 * expression.trusted,
        expression.largest, expression.rounds);
  }
  say("\n");
  printSeconds(report.seconds);
}

void printSolvedClip(const SolvedClip& clip) {
  RigResidual worst;
  double mean = 0.0;
  for (const RigResidual& residual : clip.residuals) {
    mean += residual.mean / static_cast<double>(clip.residuals.size());
    if (residual.mean > worst.mean) worst = residual;
  }
  say("{} frames, {} shapes; distance to the meshes: mean {:.3f} mm; worst frame: mean {:.3f}, 99th pct {:.3f}, "
      "largest {:.3f} mm\n",
      clip.weights.size(), clip.shapes.size(), mean, worst.mean, worst.percentile_99, worst.largest);
  say("{:.2f} s, {:.1f} frames a second, reading included\n", clip.seconds,
      static_cast<double>(clip.weights.size()) / std::max(clip.seconds, 1e-9));
}

}  // namespace facezip::cli
