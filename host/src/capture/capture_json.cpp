#include "capture/capture_json.hpp"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "facezip/error.hpp"

namespace facezip {
namespace {
using nlohmann::json;

/// Reads the fields of one JSON object and names what is wrong with them.
class Fields {
 public:
  Fields(std::string file, std::string where, const json& object)
      : file_(std::move(file)), where_(std::move(where)), object_(object) {
    if (!object.is_object()) fail("", "an object", object);
  }

  std::string text(const std::string& field) const {
    if (!object_.contains(field)) return "";
    const json& value = object_[field];
    if (!value.is_string()) fail(field, "a string", value);
    return value.get<std::string>();
  }

  double weight(const std::string& field) const {
    if (!object_.contains(field)) return 1.0;
    const json& value = object_[field];
    if (!value.is_number() || !std::isfinite(value.get<double>()) || value.get<double>() < 0.0) {
      fail(field, "a number >= 0", value);
    }
    return value.get<double>();
  }

  std::vector<std::string> names(const std::string& field) const {
    std::vector<std::string> names;
    if (!object_.contains(field)) return names;
    if (!object_[field].is_array()) fail(field, "a list of names", object_[field]);
    for (const json& value : object_[field]) {
      if (!value.is_string() || value.get<std::string>().empty()) fail(field, "a list of names", value);
      names.push_back(value.get<std::string>());
    }
    return names;
  }

  [[noreturn]] void fail(const std::string& field, const std::string& expected, const json& got) const {
    throw InputError({file_, where_ + field, expected, got.dump().substr(0, 60), "see docs/capture_format.md"});
  }

 private:
  std::string file_;
  std::string where_;
  const json& object_;
};

CaptureJson::Map readMap(const std::string& file, const std::string& name, const json& object) {
  const Fields fields(file, fmt::format("maps.{}.", name), object);
  CaptureJson::Map map;
  map.colour_space = fields.text("colour_space");
  map.weight = fields.weight("weight");
  map.neutral = fields.text("neutral");
  if (!object.contains("expressions")) return map;
  const Fields files(file, fmt::format("maps.{}.expressions.", name), object["expressions"]);
  for (const auto& [expression, value] : object["expressions"].items())
    map.expressions[expression] = files.text(expression);
  return map;
}

}  // namespace

std::optional<CaptureJson> readCaptureJson(const std::filesystem::path& file) {
  std::ifstream stream(file);
  if (!stream) return std::nullopt;
  json root;
  try {
    root = json::parse(stream);
  } catch (const json::parse_error& error) {
    throw InputError({file.string(), fmt::format("byte {}", error.byte), "JSON", error.what(), ""});
  }
  const Fields fields(file.string(), "", root);
  CaptureJson description;
  description.name = fields.text("name");
  description.unit = fields.text("unit");
  description.neutral_mesh = fields.text("neutral_mesh");
  description.face_region = fields.text("face_region");
  description.coverage = fields.text("coverage");
  description.importance = fields.text("importance");
  description.expressions = fields.names("expressions");
  if (!root.contains("maps")) return description;
  if (!root["maps"].is_object()) fields.fail("maps", "an object of maps by name", root["maps"]);
  for (const auto& [name, map] : root["maps"].items()) description.maps[name] = readMap(file.string(), name, map);
  return description;
}

}  // namespace facezip
