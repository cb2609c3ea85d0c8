#include "facezip/geometry/length.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <vector>

#include "facezip/error.hpp"

namespace facezip::geometry {
namespace {

struct UnitRow {
  LengthUnit unit;
  double metres;
  const char* symbol;
  std::array<std::string_view, 6> names;
};

constexpr std::array<UnitRow, 6> kUnits = {{
    {LengthUnit::kMillimetre, 1e-3, "mm", {"mm", "millimetre", "millimetres", "millimeter", "millimeters"}},
    {LengthUnit::kCentimetre, 1e-2, "cm", {"cm", "centimetre", "centimetres", "centimeter", "centimeters"}},
    {LengthUnit::kDecimetre, 1e-1, "dm", {"dm", "decimetre", "decimetres", "decimeter", "decimeters"}},
    {LengthUnit::kMetre, 1, "m", {"m", "metre", "metres", "meter", "meters"}},
    {LengthUnit::kInch, 0.0254, "in", {"in", "inch", "inches", "\""}},
    {LengthUnit::kFoot, 0.3048, "ft", {"ft", "foot", "feet", "'"}},
}};
constexpr const char* kUnitList = "a unit: mm, cm, dm, m, in or ft";

const UnitRow& rowOf(LengthUnit unit) { return kUnits[static_cast<std::size_t>(unit)]; }

std::string_view trim(std::string_view text) {
  const auto blank = [](char c) { return std::isspace(static_cast<unsigned char>(c)) != 0; };
  while (!text.empty() && blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && blank(text.back())) text.remove_suffix(1);
  return text;
}

std::string lowerCase(std::string_view text) {
  std::string lower(text);
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return lower;
}

// Bounding boxes of adult and child heads in metres, as they are captured: extents from the smallest to the largest.
// A head is 0.14 to 0.17 m wide (0.19 across the ears), 0.18 to 0.21 m deep and 0.21 to 0.25 m high; the ranges leave
// room for a neck, for hair, and for what a scan cuts off. The widest, 0.10 to 0.60, is below a factor of 10: no mesh
// fits two metric units. An inch is 2.54 cm, so there the smallest extent decides: heads from 0.12 on are no busts up
// to 0.30.
struct Build {
  const char* name;
  std::array<double, 2> smallest, middle, largest;  // from, to
};
constexpr std::array<Build, 3> kBuilds = {{
    {"face", {0.04, 0.15}, {0.10, 0.20}, {0.13, 0.26}},
    {"head", {0.12, 0.26}, {0.15, 0.32}, {0.19, 0.45}},
    {"bust", {0.16, 0.30}, {0.28, 0.60}, {0.30, 0.70}},
}};

bool fits(double metres, const std::array<double, 2>& range) { return metres >= range[0] && metres <= range[1]; }

// Extents of the vertices that triangles use, ascending; those of others are leftovers of modelling.
std::array<double, 3> sortedExtents(const TriangleMesh& mesh) {
  if (mesh.triangles.rows() == 0) throw InputError({"", "unit of the mesh", "a mesh", "no triangles", ""});
  Eigen::RowVector3d low = mesh.positions.row(mesh.triangles(0, 0));
  Eigen::RowVector3d high = low;
  for (const int vertex : mesh.triangles.reshaped()) {
    low = low.cwiseMin(mesh.positions.row(vertex));
    high = high.cwiseMax(mesh.positions.row(vertex));
  }
  const Eigen::RowVector3d extents = high - low;
  std::array<double, 3> sorted = {extents[0], extents[1], extents[2]};
  std::sort(sorted.begin(), sorted.end());
  return sorted;
}

// The first build that the extents have in this unit, or nullptr.
const Build* fittingBuild(const std::array<double, 3>& extents, LengthUnit unit) {
  const double metres = metresPerUnit(unit);
  for (const Build& build : kBuilds) {
    if (fits(extents[0] * metres, build.smallest) && fits(extents[1] * metres, build.middle) &&
        fits(extents[2] * metres, build.largest)) {
      return &build;
    }
  }
  return nullptr;
}

}  // namespace

double metresPerUnit(LengthUnit unit) { return rowOf(unit).metres; }

std::string unitSymbol(LengthUnit unit) { return rowOf(unit).symbol; }

LengthUnit parseUnit(std::string_view name) {
  const std::string lower = lowerCase(trim(name));
  for (const UnitRow& row : kUnits) {
    if (!lower.empty() && std::find(row.names.begin(), row.names.end(), lower) != row.names.end()) return row.unit;
  }
  throw InputError({"", "unit", kUnitList, fmt::format("\"{}\"", name), ""});
}

Length parseLength(std::string_view text) {
  const std::string_view trimmed = trim(text);
  Length length;
  const auto [end, error] = std::from_chars(trimmed.data(), trimmed.data() + trimmed.size(), length.value);
  if (error != std::errc() || !std::isfinite(length.value) || length.value <= 0) {
    throw InputError({"", "length", "a number above 0 and a unit, such as 3cm", fmt::format("\"{}\"", text), ""});
  }
  const std::string_view unit = trimmed.substr(static_cast<std::size_t>(end - trimmed.data()));
  if (!unit.empty()) length.unit = parseUnit(unit);
  return length;
}

double toMeshUnits(const Length& length, LengthUnit mesh_unit) {
  if (!length.unit || *length.unit == mesh_unit) return length.value;
  return length.value * metresPerUnit(*length.unit) / metresPerUnit(mesh_unit);
}

UnitGuess guessUnit(const TriangleMesh& mesh) {
  const std::array<double, 3> extents = sortedExtents(mesh);
  const std::string size = fmt::format("{:.4g} x {:.4g} x {:.4g}", extents[0], extents[1], extents[2]);
  std::vector<LengthUnit> units;
  std::string readings;
  for (const LengthUnit unit :
       {LengthUnit::kMillimetre, LengthUnit::kCentimetre, LengthUnit::kMetre, LengthUnit::kInch}) {
    const Build* build = fittingBuild(extents, unit);
    if (build == nullptr) continue;
    readings += fmt::format("{}a {} {:.2f} m long in {}", units.empty() ? "" : " or ", build->name,
                            extents[2] * metresPerUnit(unit), unitSymbol(unit));
    units.push_back(unit);
  }
  if (units.size() != 1) {
    throw InputError({"", "unit of the mesh", "the size of a head in mm, cm, m or in",
                      units.empty() ? size + ", which is none" : size + ", which may be " + readings,
                      "state \"unit\" in capture.json or pass --unit"});
  }
  return {units.front(), fmt::format("the mesh measures {}, {}: its unit is taken to be {}", size, readings,
                                     unitSymbol(units.front()))};
}

}  // namespace facezip::geometry
