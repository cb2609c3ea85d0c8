#include "capture/capture_json.hpp"

#include "capture/found_maps.hpp"
#include "facezip/error.hpp"
#include "image/map_fields.hpp"
#include "io/composed.hpp"
#include "io/json_field.hpp"
#include "io/quoted.hpp"
#include "io/read_file.hpp"

namespace facezip {
namespace fs = std::filesystem;
namespace {
using io::JsonField;

constexpr const char* kCure = "see docs/capture_format.md";

std::string optionalText(const JsonField& object, const std::string& key) {
  return object.has(key) ? object[key].text() : "";
}

/// What `read` makes of each member of an object, by its name. A name that stands there twice, spelt in two ways, is
/// refused.
template <typename Read>
auto byName(const JsonField& object, const Read& read) {
  std::map<std::string, decltype(read(object))> found;
  for (const auto& member : object.object().items()) {
    const JsonField field = object[member.key()];
    if (found.emplace(io::composed(member.key()), read(field)).second) continue;
    object.fail("each name once", io::quoted(member.key()) + " twice", kCure);
  }
  return found;
}

std::map<std::string, std::string> filesByExpression(const JsonField& object) {
  return byName(object, [](const JsonField& file) { return file.text(); });
}

CaptureJson::Map readMap(const JsonField& field) {
  CaptureJson::Map map;
  if (field.has("colour_space")) map.colour_space = image::parseColourSpace(field["colour_space"]);
  if (field.has("weight")) map.weight = image::parseMetricWeight(field["weight"]);
  map.folder = optionalText(field, "folder");
  map.neutral = optionalText(field, "neutral");
  if (field.has("expressions")) map.expressions = filesByExpression(field["expressions"]);
  return map;
}

}  // namespace

std::optional<CaptureJson> readCaptureJson(const fs::path& file) {
  std::error_code error;
  // A link that leads nowhere is something, and an error.
  if (fs::symlink_status(file, error).type() == fs::file_type::not_found) return std::nullopt;
  const nlohmann::json json = io::parseJson(io::readFile(file, "the description of a capture"), file.string(), kCure);
  const JsonField root(json, file.string(), "", kCure);
  CaptureJson description;
  description.name = io::composed(optionalText(root, "name"));
  description.unit = optionalText(root, "unit");
  description.neutral = io::composed(optionalText(root, "neutral"));
  description.meshes = optionalText(root, "meshes");
  description.neutral_mesh = optionalText(root, "neutral_mesh");
  description.mesh = io::composed(optionalText(root, "mesh"));
  if (root.has("tile")) description.tile = root["tile"].integer(kFirstTile, kLastTile);
  description.face_region = optionalText(root, "face_region");
  description.coverage = optionalText(root, "coverage");
  description.importance = optionalText(root, "importance");
  if (root.has("expressions")) {
    for (const JsonField& name : root["expressions"].elements(0, image::kMaxExpressions)) {
      description.expressions.push_back(io::composed(name.text()));
    }
  }
  if (root.has("expression_meshes")) description.expression_meshes = filesByExpression(root["expression_meshes"]);
  if (root.has("maps")) description.maps = byName(root["maps"], readMap);
  return description;
}

}  // namespace facezip
