#include "blend/shape_names.hpp"

#include <algorithm>
#include <cctype>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string_view>
#include <utility>

#include "blend/shape_names_file.hpp"
#include "io/composed.hpp"

namespace facezip::blend {
namespace {

std::string lowered(std::string_view name) {
  std::string lower(name);
  std::ranges::transform(lower, lower.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return lower;
}

/// The names, in lower case.
struct Table {
  std::map<std::string, std::string> shapes;                    ///< any name to the first of its row, or group
  std::multimap<std::string, std::vector<std::string>> groups;  ///< any name to shapes
  std::set<std::string> no_shapes;
};

const Table& table() {
  static const Table read = [] {
    Table made;
    const auto json = nlohmann::json::parse(embeddedShapeNames().at("shape_names.json"));
    const auto rowOf = [&](const std::string& name) { return made.shapes.at(lowered(name)); };
    for (const auto& row : json["shapes"]) {
      for (const auto& name : row) made.shapes[lowered(name.get<std::string>())] = lowered(row[0].get<std::string>());
    }
    for (const auto& group : json["groups"]) {
      std::vector<std::string> shapes;
      for (const auto& name : group["of"]) shapes.push_back(rowOf(name.get<std::string>()));
      for (const auto& name : group["names"]) {
        const std::string lower = lowered(name.get<std::string>());
        made.groups.emplace(lower, shapes);
        made.shapes.try_emplace(lower, lowered(group["names"][0].get<std::string>()));
      }
    }
    for (const auto& name : json["no_shapes"]) made.no_shapes.insert(lowered(name.get<std::string>()));
    return made;
  }();
  return read;
}

/// What two names of one shape have in common.
std::string shapeOf(const std::string& name) {
  const std::string lower = lowered(name);
  const auto found = table().shapes.find(lower);
  return found == table().shapes.end() ? lower : found->second;
}

/// Expressions by the shape that they show; not those of which there are two.
std::map<std::string, std::size_t> byShape(const std::vector<std::string>& names) {
  std::map<std::string, std::size_t> found;
  std::set<std::string> twice;
  for (std::size_t n = 0; n < names.size(); ++n) {
    const std::string shape = shapeOf(names[n]);
    if (!found.emplace(shape, n).second) twice.insert(shape);
  }
  for (const std::string& shape : twice) found.erase(shape);
  return found;
}

/// Matches names in rounds: what one has driven, the next leave alone.
class Matcher {
 public:
  Matcher(const std::vector<std::string>& given, const std::vector<std::string>& names)
      : given_(given), by_shape_(byShape(names)), matches_(given.size()), driven_(names.size(), false) {
    for (std::size_t n = 0; n < names.size(); ++n) {
      by_name_.emplace(names[n], n);
      const auto [begin, end] = table().groups.equal_range(lowered(names[n]));
      for (auto group = begin; group != end; ++group) wholes_.emplace_back(n, &group->second);
    }
  }

  std::vector<NameMatch> match() {
    driveOne([this](const std::string& name) { return exact(name); });
    driveOne([this](const std::string& name) { return named(shapeOf(name)); });
    driveSeveral();
    return matches_;
  }

 private:
  std::optional<std::size_t> exact(const std::string& name) const {
    const auto found = by_name_.find(name);
    return found == by_name_.end() ? std::nullopt : std::optional(found->second);
  }

  std::optional<std::size_t> named(const std::string& shape) const {
    const auto found = by_shape_.find(shape);
    return found == by_shape_.end() ? std::nullopt : std::optional(found->second);
  }

  bool isOpen(const NameMatch& match) const { return match.drives.empty() && !match.repeats; }

  template <typename Find>
  void driveOne(const Find& find) {
    std::map<std::size_t, std::size_t> drivers;  // of this round
    for (std::size_t g = 0; g < given_.size(); ++g) {
      if (!isOpen(matches_[g])) continue;
      const std::optional<std::size_t> n = find(io::composed(given_[g]));
      if (!n || driven_[*n]) continue;
      const auto [driver, first] = drivers.emplace(*n, g);
      if (first) {
        matches_[g].drives.push_back({*n, 1.0f});
      } else {
        matches_[g].repeats = driver->second;
      }
    }
    for (const auto& [n, g] : drivers) driven_[n] = true;
  }

  void driveSeveral() {
    for (std::size_t g = 0; g < given_.size(); ++g) {
      if (!isOpen(matches_[g])) continue;
      const std::string name = lowered(io::composed(given_[g]));
      const auto [begin, end] = table().groups.equal_range(name);
      for (auto group = begin; group != end; ++group) driveEach(g, group->second);
      if (begin == end) driveWhole(g, shapeOf(name));
    }
  }

  /// Every expression of a group, by the group's name.
  void driveEach(std::size_t g, const std::vector<std::string>& shapes) {
    for (const std::string& shape : shapes) {
      const std::optional<std::size_t> n = named(shape);
      if (!n || driven_[*n]) continue;
      matches_[g].drives.push_back({*n, 1.0f});
      driven_[*n] = true;
    }
  }

  /// Expressions that show several shapes, by the name of one.
  void driveWhole(std::size_t g, const std::string& shape) {
    for (const auto& [n, shapes] : wholes_) {
      if (driven_[n] || std::ranges::find(*shapes, shape) == shapes->end()) continue;
      if (parts_.emplace(n, shape).second) {
        matches_[g].drives.push_back({n, 1.0f / static_cast<float>(shapes->size())});
      }
    }
  }

  const std::vector<std::string>& given_;
  std::map<std::string, std::size_t> by_name_;
  const std::map<std::string, std::size_t> by_shape_;
  std::vector<std::pair<std::size_t, const std::vector<std::string>*>> wholes_;  ///< expressions of several shapes
  std::vector<NameMatch> matches_;
  std::vector<bool> driven_;
  std::set<std::pair<std::size_t, std::string>> parts_;  ///< expressions and shapes that drive them already
};

}  // namespace

std::vector<NameMatch> matchNames(const std::vector<std::string>& given, const std::vector<std::string>& names) {
  return Matcher(given, names).match();
}

std::optional<std::size_t> findName(const std::string& name, const std::vector<std::string>& names) {
  const std::string composed = io::composed(name);
  const auto exact = std::ranges::find(names, composed);
  if (exact != names.end()) return static_cast<std::size_t>(exact - names.begin());
  const std::map<std::string, std::size_t> shapes = byShape(names);
  const auto found = shapes.find(shapeOf(composed));
  return found == shapes.end() ? std::nullopt : std::optional(found->second);
}

bool isNoShape(const std::string& name) { return table().no_shapes.contains(lowered(name)); }

}  // namespace facezip::blend
