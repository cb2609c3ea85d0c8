#include "rig/part_looks.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "mesh/map_roles.hpp"
#include "rig/part_looks_file.hpp"

namespace facezip::rig {
namespace {

template <typename Value, std::size_t kCount>
using Names = std::array<std::pair<const char*, Value>, kCount>;

constexpr Names<PartPlace, 4> kPlaces = {
    {{"alone", PartPlace::kAlone}, {"eye", PartPlace::kEye}, {"mouth", PartPlace::kMouth}, {"skin", PartPlace::kSkin}}};
constexpr Names<PartPaint, 4> kPaints = {{{"none", PartPaint::kNone},
                                          {"iris", PartPaint::kIris},
                                          {"hairs", PartPaint::kHairs},
                                          {"shade", PartPaint::kShade}}};
constexpr Names<PackageMaterial::Alpha, 3> kAlphas = {{{"opaque", PackageMaterial::Alpha::kOpaque},
                                                       {"mask", PackageMaterial::Alpha::kMask},
                                                       {"blend", PackageMaterial::Alpha::kBlend}}};

template <typename Value, std::size_t kCount>
Value valueOf(const Names<Value, kCount>& names, const nlohmann::json& field) {
  const std::string name = field.get<std::string>();
  return std::ranges::find(names, name, &std::pair<const char*, Value>::first)->second;  // of our own file
}

/// sRGB to linear light.
double toLinear(double c) { return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4); }

struct Row {
  std::vector<std::string> words, against;
  PartLook look;
};

Row readRow(const nlohmann::json& json) {
  Row row{json.at("words"), json.at("not"), {}};
  for (std::size_t c = 0; c < 3; ++c) {
    row.look.material.colour[c] = toLinear(json.at("colour").at(c).get<double>() / 255.0);
  }
  row.look.material.opacity = json.at("opacity");
  row.look.material.roughness = json.at("roughness");
  row.look.material.alpha = valueOf(kAlphas, json.at("alpha"));
  row.look.place = valueOf(kPlaces, json.at("place"));
  row.look.paint = valueOf(kPaints, json.at("paint"));
  return row;
}

const nlohmann::json& document() {
  static const nlohmann::json json = nlohmann::json::parse(embeddedPartLooks().at("part_looks.json"));
  return json;
}

std::vector<Row> readTable() {
  std::vector<Row> rows;
  for (const nlohmann::json& json : document().at("looks")) rows.push_back(readRow(json));
  return rows;
}

}  // namespace

PartLook lookOf(const std::string& name) {
  static const std::vector<Row> rows = readTable();
  const auto found = std::ranges::find_if(
      rows, [&](const Row& row) { return mesh::nameHolds(name, row.words) && !mesh::nameHolds(name, row.against); });
  return found != rows.end() ? found->look : readRow(document().at("other")).look;
}

std::vector<KnownPart> knownParts(int vertices) {
  std::vector<KnownPart> parts;
  for (const nlohmann::json& topology : document().at("topologies")) {
    if (topology.at("vertices") != vertices) continue;
    for (const nlohmann::json& part : topology.at("parts")) {
      parts.push_back({part.at("name"), part.at("first"), part.at("last")});
    }
  }
  return parts;
}

}  // namespace facezip::rig
