#include "capture/expression_meshes.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <system_error>

#include "capture/mesh_names.hpp"
#include "facezip/geometry/obj_io.hpp"
#include "io/composed.hpp"
#include "scene/morph_mesh.hpp"

namespace facezip {
namespace fs = std::filesystem;
namespace {

constexpr const char* kUsualFolder = "expressions";
constexpr const char* kWhereTheyBelong = "meshes belong in expressions/, or in \"expression_meshes\" of capture.json";

using Meshes = std::map<std::string, fs::path>;  // by name

/// The OBJ files of a folder, which may be absent; not the neutral.
Meshes meshesIn(const fs::path& folder) {
  Meshes meshes;
  std::error_code error;
  if (!fs::exists(folder, error) && !error) return meshes;
  for (const fs::path& file : geometry::objFiles(folder)) {
    const std::string name = io::composed(file.stem().string());
    const auto [it, inserted] = meshes.emplace(name, file);
    if (inserted) continue;
    throw InputError({folder.string(), fmt::format("mesh \"{}\"", name), "one file",
                      "two, whose names are spelt with other characters and look alike", "remove one"});
  }
  return meshes;
}

/// Those of the folder that capture.json names.
Meshes namedMeshes(const fs::path& capture, const fs::path& folder) {
  Meshes meshes = meshesIn(folder);
  if (!meshes.empty()) return meshes;
  std::error_code error;
  throw InputError(
      {(capture / kCaptureFile).string(), "meshes", "a folder of OBJ files",
       fmt::format("{}, {}", folder.string(), fs::exists(folder, error) ? "with none" : "which is not there"),
       "name the folder of the expressions' meshes"});
}

bool isExpression(const std::string& name, const std::vector<std::string>& expressions) {
  return std::find(expressions.begin(), expressions.end(), name) != expressions.end();
}

/// "a, b, c and 9 more"
std::string listed(const std::vector<std::string>& names) {
  constexpr std::size_t kMostListed = 8;
  const std::size_t shown = names.size() > kMostListed + 1 ? kMostListed : names.size();
  const std::string more = shown < names.size() ? fmt::format(" and {} more", names.size() - shown) : "";
  return fmt::format("{}{}", fmt::join(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(shown), ", "), more);
}

/// Other places of OBJ files in a capture.
struct OtherFolders {
  std::vector<fs::path> matching;  ///< with the mesh of at least one expression
  std::vector<fs::path> others;
};

OtherFolders otherFolders(const fs::path& capture, const std::vector<std::string>& expressions) {
  OtherFolders found;
  std::error_code error;
  std::vector<fs::path> folders = {capture};
  for (fs::directory_iterator entry(capture, error); !error && entry != fs::directory_iterator();
       entry.increment(error)) {
    std::error_code ignored;
    const std::string name = entry->path().filename().string();
    if (entry->is_directory(ignored) && name.front() != '.' && name != kUsualFolder) folders.push_back(entry->path());
  }
  std::sort(folders.begin(), folders.end());
  for (const fs::path& folder : folders) {
    Meshes meshes = meshesIn(folder);
    const bool has_neutral =
        std::erase_if(meshes, [](const auto& mesh) { return isNeutralMesh(mesh.first); }) > 0 && folder != capture;
    std::erase_if(meshes, [](const auto& mesh) { return isIdentityMesh(mesh.first); });
    const bool matches = std::any_of(meshes.begin(), meshes.end(),
                                     [&](const auto& mesh) { return isExpression(mesh.first, expressions); });
    if (matches && !has_neutral) {
      found.matching.push_back(folder);
    } else if (!meshes.empty()) {
      found.others.push_back(folder);
    }
  }
  return found;
}

std::string namesOf(const std::vector<fs::path>& folders, const fs::path& capture) {
  std::vector<std::string> names;
  for (const fs::path& folder : folders) {
    names.push_back(folder == capture ? "the capture itself" : folder.filename().string() + "/");
  }
  return fmt::format("{}", fmt::join(names, " and "));
}

/// Says which meshes stay unused and who lacks one: a misspelt name would otherwise go unnoticed.
void noteUnmatched(const fs::path& folder, const Meshes& meshes, const std::string& neutral,
                   const std::vector<std::string>& expressions, const std::vector<fs::path>& taken,
                   Progress& progress) {
  std::vector<std::string> unused, lacking;
  for (const auto& [name, file] : meshes) {
    if (!isExpression(name, expressions) && name != neutral && !isNeutralMesh(name))
      unused.push_back(file.filename().string());
  }
  for (std::size_t n = 0; n < expressions.size(); ++n) {
    if (taken[n].empty()) lacking.push_back(expressions[n]);
  }
  std::string text;
  if (!unused.empty()) {
    text = fmt::format("{} match{} no expression", listed(unused), unused.size() == 1 ? "es" : "");
  }
  if (!lacking.empty() && lacking.size() < expressions.size()) {
    text += fmt::format("{}no mesh for {}", text.empty() ? "" : "; ", listed(lacking));
  }
  if (!text.empty()) progress.note(fmt::format("{}: {} (meshes are named as textures are)", folder.string(), text));
}

/// Says why no expression has a mesh.
void noteNone(const fs::path& capture, const OtherFolders& others, Progress& progress) {
  std::string why = "no meshes of expressions";
  if (others.matching.size() > 1) {
    why += fmt::format(": {} hold some, and none is taken; {}", namesOf(others.matching, capture), kWhereTheyBelong);
  } else if (!others.others.empty()) {
    why += fmt::format(": {} {} OBJ files that are not taken; {}", namesOf(others.others, capture),
                       others.others.size() == 1 ? "holds" : "hold", kWhereTheyBelong);
  }
  progress.note(fmt::format("{}: {}: textures will change, the mesh will not move", capture.string(), why));
}

}  // namespace

std::vector<fs::path> findExpressionMeshes(const fs::path& capture, const CaptureJson& description,
                                           const std::vector<std::string>& expressions, Progress* progress) {
  const bool is_named = !description.meshes.empty();
  const std::map<std::string, std::string>& named = description.expression_meshes;
  fs::path folder = capture / (is_named ? description.meshes : kUsualFolder);
  Meshes meshes = is_named ? namedMeshes(capture, folder) : meshesIn(folder);
  OtherFolders others;
  if (meshes.empty() && named.empty()) {
    others = otherFolders(capture, expressions);
    if (others.matching.size() == 1) {
      folder = others.matching.front();
      meshes = meshesIn(folder);
      if (folder == capture) std::erase_if(meshes, [&](const auto& m) { return !isExpression(m.first, expressions); });
      if (progress != nullptr) {
        progress->note(fmt::format("{}: taken for the meshes of the expressions", folder.string()));
      }
    }
  }
  std::vector<fs::path> taken;
  for (const std::string& name : expressions) {
    const auto by_name = named.find(name);
    const auto mesh = meshes.find(name);
    taken.push_back(by_name != named.end() ? capture / by_name->second
                    : mesh != meshes.end() ? mesh->second
                                           : fs::path());
  }
  if (progress == nullptr) return taken;
  noteUnmatched(folder, meshes, description.neutral, expressions, taken, *progress);
  const bool none = std::all_of(taken.begin(), taken.end(), [](const fs::path& mesh) { return mesh.empty(); });
  if (none && !expressions.empty()) {
    noteNone(capture, others, *progress);
  }
  return taken;
}

std::vector<fs::path> findMorphTargets(const Capture& capture, const CaptureJson& description, Progress* progress) {
  const scene::MorphMesh morphs = scene::readMorphMesh(capture.neutral_mesh, capture.mesh_name);
  Meshes meshes;
  for (const auto& [name, positions] : morphs.positions) meshes.emplace(name, name);
  std::vector<fs::path> taken;
  for (const std::string& name : capture.expressions) {
    const auto named = description.expression_meshes.find(name);
    taken.push_back(named != description.expression_meshes.end() ? capture.directory / named->second
                    : morphs.positions.contains(name)            ? capture.neutral_mesh
                                                                 : fs::path());
  }
  if (progress == nullptr) return taken;
  if (!morphs.note.empty()) progress->note(morphs.note);
  noteUnmatched(capture.neutral_mesh, meshes, description.neutral, capture.expressions, taken, *progress);
  const bool none = std::ranges::all_of(taken, [](const fs::path& mesh) { return mesh.empty(); });
  if (none && !capture.expressions.empty()) noteNone(capture.directory, {}, *progress);
  return taken;
}

}  // namespace facezip
