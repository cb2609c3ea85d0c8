#include "rig/rig_json.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <system_error>
#include <unordered_map>

#include "facezip/error.hpp"
#include "facezip/version.hpp"
#include "image/map_fields.hpp"
#include "io/folder.hpp"
#include "io/json_field.hpp"
#include "io/quoted.hpp"
#include "io/safe_names.hpp"

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

namespace {

/// M names in the order of the file, and where each stands in it.
class ShapeNames {
 public:
  explicit ShapeNames(const std::vector<io::JsonField>& fields) {
    for (const io::JsonField& field : fields) {
      const std::string name = io::fileSafeName(field);  // names an OBJ file
      if (!index_.emplace(name, names_.size()).second) field.fail("unique names of shapes", field.got() + " twice");
      names_.push_back(name);
    }
  }

  const std::vector<std::string>& all() const { return names_; }

  std::size_t at(const std::string& name, const io::JsonField& weights) const {
    const auto found = index_.find(name);
    if (found == index_.end()) weights.fail("names of shapes", io::quoted(name));
    return found->second;
  }

 private:
  std::vector<std::string> names_;
  std::unordered_map<std::string, std::size_t> index_;
};

std::vector<double> parseWeights(const io::JsonField& field, const ShapeNames& shapes) {
  std::vector<double> weights(shapes.all().size(), 0.0);
  for (const auto& [shape, weight] : field.object().items()) {
    weights[shapes.at(shape, field)] = field[shape].number(0.0, 1.0);
  }
  return weights;
}

}  // namespace

void requireRigSize(std::size_t shapes, std::size_t expressions, const std::string& file) {
  if (shapes <= kMostShapes && shapes * expressions <= kMostRigWeights) return;
  throw InputError(
      {file, "shapes",
       fmt::format("at most {}, and {} weights of {} expressions", kMostShapes, kMostRigWeights, expressions),
       fmt::format("{}", shapes), ""});
}

Rig parseRig(const std::string& text, const std::string& file) {
  const nlohmann::json document = io::parseJson(text, file);
  const io::JsonField root(document, file, "");
  if (root["format"].text() != "facezip-rig") root["format"].fail("\"facezip-rig\"", root["format"].got());
  root["version"].integer(kRigVersion, kRigVersion);
  Rig found;
  found.millimetres_per_unit = root["millimetres_per_unit"].number(1e-9, 1e9);
  found.skin_vertices = root["skin_vertices"].integer(1, 1 << 30);
  const ShapeNames shapes(root["shapes"].elements(1, kMostShapes));
  found.shapes = shapes.all();
  const std::vector<io::JsonField> expressions = root["expressions"].elements(0, image::kMaxExpressions);
  requireRigSize(found.shapes.size(), expressions.size(), file);
  for (const io::JsonField& expression : expressions) {
    found.package_expressions.push_back(io::fileSafeName(expression["name"]));
    found.expressions.push_back(io::fileSafeName(expression["captured"]));
    found.weights.push_back(parseWeights(expression["weights"], shapes));
  }
  return found;
}

}  // namespace rig

namespace {

Rig readRig(const io::Folder& folder) {
  const InputFile file = folder.open(rig::kRigFile, "rig.json of a package that `facezip rig` made");
  Rig found = rig::parseRig(file.read(rig::kMostRigBytes), (folder.path() / rig::kRigFile).string());
  found.directory = folder.path();
  return found;
}

}  // namespace

bool isRig(const Package& package) { return package.folder().has(rig::kRigFile); }

Rig openRig(const Package& package) { return readRig(package.folder()); }

Rig openRig(const std::filesystem::path& package) {
  try {
    return readRig(io::Folder(package));
  } catch (const std::system_error& error) {
    throw InputError({(package / rig::kRigFile).string(), "", "rig.json of a package that `facezip rig` made",
                      error.code().message(), ""});
  }
}

}  // namespace facezip
