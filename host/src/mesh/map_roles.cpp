#include "mesh/map_roles.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <nlohmann/json.hpp>

#include "mesh/map_roles_file.hpp"

namespace facezip::mesh {
namespace {

constexpr std::pair<MapRole, const char*> kNames[] = {{MapRole::kAlbedo, "albedo"},
                                                      {MapRole::kNormal, "normal"},
                                                      {MapRole::kRoughness, "roughness"},
                                                      {MapRole::kOcclusion, "occlusion"}};

struct Entry {
  MapRole role = MapRole::kOther;
  std::vector<std::string> words;
  std::vector<std::string> against;
};

std::vector<Entry> readTable() {
  std::vector<Entry> table;
  const nlohmann::json document = nlohmann::json::parse(embeddedMapRoles().at("map_roles.json"));
  for (const nlohmann::json& row : document.at("roles")) {
    const auto role =
        std::ranges::find(kNames, row.at("role").get<std::string>(), &std::pair<MapRole, const char*>::second);
    table.push_back({role->first, row.at("words"), row.at("not")});
  }
  return table;
}

const std::vector<Entry>& table() {
  static const std::vector<Entry> entries = readTable();
  return entries;
}

bool isUpper(char c) { return c >= 'A' && c <= 'Z'; }
bool isLower(char c) { return c >= 'a' && c <= 'z'; }

/// "T_BaseColorMap2" gives t, base, color, map; "AOMap" gives ao, map.
std::vector<std::string> wordsOf(const std::string& name) {
  std::vector<std::string> words;
  bool open = false;
  for (std::size_t i = 0; i < name.size(); ++i) {
    const char c = name[i];
    if (!isUpper(c) && !isLower(c)) {
      open = false;
      continue;
    }
    const bool hump = isUpper(c) && i > 0 &&
                      (isLower(name[i - 1]) || (isUpper(name[i - 1]) && i + 1 < name.size() && isLower(name[i + 1])));
    if (!open || hump) words.emplace_back();
    words.back() += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    open = true;
  }
  return words;
}

bool holds(const std::vector<std::string>& words, const std::string& entry) {
  constexpr std::size_t kLong = 6;
  if (entry.size() >= kLong && fmt::format("{}", fmt::join(words, "")).find(entry) != std::string::npos) return true;
  for (std::size_t first = 0; first < words.size(); ++first) {
    std::string run;
    for (std::size_t i = first; i < words.size() && run.size() < entry.size(); ++i) run += words[i];
    if (run == entry) return true;
  }
  return false;
}

bool holdsAny(const std::vector<std::string>& words, const std::vector<std::string>& entries) {
  return std::ranges::any_of(entries, [&words](const std::string& entry) { return holds(words, entry); });
}

}  // namespace

std::string roleName(MapRole role) {
  for (const auto& [value, name] : kNames) {
    if (value == role) return name;
  }
  return "";
}

bool nameHolds(const std::string& name, const std::vector<std::string>& words) {
  return holdsAny(wordsOf(name), words);
}

MapRole roleOf(const std::string& name) {
  const std::vector<std::string> words = wordsOf(name);
  for (const Entry& entry : table()) {
    if (holdsAny(words, entry.words) && !holdsAny(words, entry.against)) return entry.role;
  }
  return MapRole::kOther;
}

std::vector<MapRole> rolesOf(const std::vector<PackageMap>& maps) {
  std::vector<MapRole> roles;
  for (const PackageMap& map : maps) {
    const MapRole role = map.sample_type == SampleType::kFloat32 ? MapRole::kOther : roleOf(map.name);
    roles.push_back(std::ranges::find(roles, role) == roles.end() ? role : MapRole::kOther);
  }
  return roles;
}

std::vector<std::string> notesOfRoles(const std::vector<PackageMap>& maps, const std::vector<MapRole>& shown) {
  const std::vector<MapRole> roles = rolesOf(maps);
  std::vector<std::string> names;
  for (const MapRole role : shown) names.push_back(roleName(role));
  const auto isShown = [&shown](MapRole role) { return std::ranges::find(shown, role) != shown.end(); };
  std::vector<std::string> notes;
  for (std::size_t m = 0; m < maps.size(); ++m) {
    if (maps[m].sample_type == SampleType::kFloat32 || isShown(roles[m])) continue;
    const MapRole asked = roleOf(maps[m].name);
    const auto holder = std::ranges::find(roles, asked);
    if (isShown(asked) && holder != roles.end()) {
      notes.push_back(fmt::format("{}: not in the material, where {} is the {}", maps[m].name,
                                  maps[static_cast<std::size_t>(holder - roles.begin())].name, roleName(asked)));
    } else {
      notes.push_back(fmt::format("{}: not in the material, which shows {} by their names (docs/export.md)",
                                  maps[m].name, fmt::join(names, ", ")));
    }
  }
  if (std::ranges::find(roles, MapRole::kAlbedo) == roles.end()) {
    notes.push_back("no map is an albedo by its name: the face is gray");
  }
  return notes;
}

}  // namespace facezip::mesh
