#include "rig/rig_json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "facezip/error.hpp"
#include "facezip/version.hpp"
#include "io/read_file.hpp"
#include "package/json_field.hpp"

namespace facezip {
namespace rig {
namespace {
using nlohmann::ordered_json;

ordered_json residualJson(const RigResidual& residual) {
  return {{"mean", residual.mean}, {"p99", residual.percentile_99}, {"max", residual.largest}};
}

}  // namespace

std::string rigJson(const RigReport& report, double millimetres_per_unit) {
  ordered_json document;
  document["format"] = "facezip-rig";
  document["version"] = kRigVersion;
  document["generator"] = "facezip " FACEZIP_VERSION;
  document["millimetres_per_unit"] = millimetres_per_unit;
  document["skin_vertices"] = report.skin_vertices;
  document["shapes"] = report.shapes;
  document["expressions"] = ordered_json::array();
  for (std::size_t n = 0; n < report.expressions.size(); ++n) {
    ordered_json weights = ordered_json::object();
    for (std::size_t m = 0; m < report.shapes.size(); ++m) {
      if (report.weights[n][m] > 0.0) weights[report.shapes[m]] = report.weights[n][m];
    }
    ordered_json expression = {{"name", report.package_expressions[n]},
                               {"captured", report.expressions[n]},
                               {"weights", weights},
                               {"residual_mm", residualJson(report.residuals[n])},
                               {"template_residual_mm", residualJson(report.template_residuals[n])}};
    if (!report.head_motions.empty()) {
      const RigHeadMotion& motion = report.head_motions[n];
      expression["head_motion"] = {{"degrees", motion.degrees}, {"mm", motion.millimetres}};
    }
    document["expressions"].push_back(std::move(expression));
  }
  document["fit"] = {{"transfer", report.transfer},
                     {"closeness", report.shape_prior},
                     {"left_out_share_of_template", report.left_out_share},
                     {"convergence_rms_mm", report.convergence},
                     {"unseen_shapes", report.unseen},
                     {"still_shapes", report.still},
                     {"degenerate_triangles", report.degenerate_triangles}};
  document["textures"] = {{"solve", report.texture_solve},         {"damping", report.texture_damping},
                          {"strain_share", report.strain_share},   {"rank", report.texture_rank},
                          {"left_out_rmse", report.left_out_rmse}, {"left_out_nothing", report.left_out_nothing}};
  return document.dump(2) + "\n";
}

}  // namespace rig

bool isRig(const std::filesystem::path& package) {
  std::error_code error;
  return std::filesystem::exists(package / rig::kRigFile, error);
}

Rig openRig(const std::filesystem::path& package) {
  const std::filesystem::path file = package / rig::kRigFile;
  const std::string text = io::readFile(file, "rig.json of a package that `facezip rig` made");
  const nlohmann::json document = package::parseJson(text, file.string());
  const package::JsonField root(document, file.string(), "");
  if (root["format"].text() != "facezip-rig") root["format"].fail("\"facezip-rig\"", root["format"].got());
  root["version"].integer(rig::kRigVersion, rig::kRigVersion);
  Rig found;
  found.directory = package;
  found.millimetres_per_unit = root["millimetres_per_unit"].number(1e-9, 1e9);
  found.skin_vertices = root["skin_vertices"].integer(1, 1 << 30);
  for (const package::JsonField& name : root["shapes"].elements(1, 65536)) {
    if (name.text().empty() || name.text().find_first_of("/\\") != std::string::npos || name.text().front() == '.') {
      name.fail("a name without / and \\", name.got());
    }
    found.shapes.push_back(name.text());
  }
  for (const package::JsonField& expression : root["expressions"].elements(1, 65536)) {
    found.package_expressions.push_back(expression["name"].text());
    found.expressions.push_back(expression["captured"].text());
    std::vector<double>& weights = found.weights.emplace_back(found.shapes.size(), 0.0);
    const nlohmann::json& given = expression["weights"].object();
    for (const auto& [shape, weight] : given.items()) {
      const auto at = std::find(found.shapes.begin(), found.shapes.end(), shape);
      if (at == found.shapes.end()) expression["weights"].fail("names of shapes", shape);
      weights[static_cast<std::size_t>(at - found.shapes.begin())] =
          package::JsonField(weight, file.string(), expression["weights"].path() + "." + shape).number(0.0, 1.0);
    }
  }
  return found;
}

}  // namespace facezip
