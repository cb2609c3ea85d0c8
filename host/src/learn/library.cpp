#include "learn/library.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "capture/capture_meshes.hpp"
#include "face/face.hpp"
#include "facezip/geometry/length.hpp"
#include "facezip/geometry/topology.hpp"
#include "io/quoted.hpp"
#include "rig/weight_guess.hpp"

namespace facezip::learn {
namespace fs = std::filesystem;
namespace {

std::vector<fs::path> subjectFolders(const fs::path& directory) {
  std::error_code error;
  if (!fs::is_directory(directory, error)) {
    throw InputError({directory.string(), "", "a library: a directory of captures",
                      fs::exists(directory, error) ? "a file" : "no such directory", ""});
  }
  const fs::path inner = directory / "subjects";
  std::vector<fs::path> folders;
  for (const fs::directory_entry& entry : fs::directory_iterator(fs::is_directory(inner, error) ? inner : directory)) {
    if (entry.is_directory(error) && !entry.path().filename().string().starts_with('.'))
      folders.push_back(entry.path());
  }
  std::ranges::sort(folders);
  if (folders.size() < 2) {
    throw InputError({directory.string(), "library", "captures of at least two people, a directory each",
                      fmt::format("{}", folders.size()),
                      "what one person does says nothing of another; `facezip rig` makes a rig of one capture"});
  }
  return folders;
}

/// Names the first expression that only one of the two has.
void requireExpressions(const Capture& capture, const Capture& first) {
  if (capture.expressions == first.expressions) return;
  const auto lacks = [](const Capture& in, const Capture& of) {
    std::vector<std::string> names;
    for (const std::string& name : of.expressions) {
      if (std::ranges::find(in.expressions, name) == in.expressions.end()) names.push_back(io::quoted(name));
    }
    return names;
  };
  const std::vector<std::string> missing = lacks(capture, first), further = lacks(first, capture);
  const std::string got = !missing.empty()   ? fmt::format("none of {}", fmt::join(missing, ", "))
                          : !further.empty() ? fmt::format("{} besides", fmt::join(further, ", "))
                                             : "another order";
  throw InputError({capture.directory.string(), "expressions",
                    fmt::format("those of {}, {} of them", first.directory.string(), first.expressions.size()), got,
                    "complete the subject, or take it out of the library"});
}

std::vector<std::string> commonMaps(const std::vector<Capture>& subjects, Progress& progress) {
  std::vector<std::string> common, others;
  const auto has = [](const Capture& capture, const std::string& name) {
    return std::ranges::any_of(capture.maps, [&](const CaptureMap& map) { return map.name == name; });
  };
  for (const Capture& subject : subjects) {
    for (const CaptureMap& map : subject.maps) {
      std::vector<std::string>& list =
          std::ranges::all_of(subjects, [&](const Capture& other) { return has(other, map.name); }) ? common : others;
      if (std::ranges::find(list, map.name) == list.end()) list.push_back(map.name);
    }
  }
  if (!others.empty()) {
    progress.note(fmt::format("{}: not every subject has it, so it is not learned", fmt::join(others, ", ")));
  }
  std::ranges::sort(common);
  return common;
}

}  // namespace

Library openLibrary(const fs::path& directory, const fs::path& facs, const std::vector<std::string>& shapes,
                    const std::vector<std::string>& maps, Progress& progress) {
  Library library;
  library.directory = directory;
  for (const fs::path& folder : subjectFolders(directory)) {
    progress.checkCancelled();
    library.subjects.push_back(openCapture(folder, maps, &progress));
    requireExpressions(library.subjects.back(), library.subjects.front());
  }
  library.expressions = library.subjects.front().expressions;
  library.maps = maps.empty() ? commonMaps(library.subjects, progress) : maps;
  library.asked = rig::readGuess(facs, library.expressions, shapes);
  return library;
}

geometry::LengthUnit unitOf(const Capture& capture, const geometry::TriangleMesh& neutral, const std::string& unit,
                            Progress& progress) {
  const std::string stated = unit.empty() ? capture.unit : unit;
  if (!stated.empty()) return geometry::parseUnit(stated);
  try {
    const geometry::UnitGuess guess = geometry::guessUnit(neutral);
    progress.note(guess.explanation);
    return guess.unit;
  } catch (const InputError& error) {
    throw error.in(capture.neutral_mesh.string());
  }
}

SubjectMeshes readMeshes(const Capture& capture, const Eigen::MatrixX3d& frame, const geometry::TriangleMesh* like,
                         const std::string& like_file, Progress& progress) {
  SubjectMeshes meshes;
  meshes.neutral = CaptureMeshes(capture).neutral();
  if (like != nullptr) {
    geometry::requireSameTopology(*like, like_file, meshes.neutral, capture.neutral_mesh.string());
  }
  const double scale = 1000.0 * geometry::metresPerUnit(unitOf(capture, meshes.neutral, "", progress));
  const std::vector<Eigen::MatrixX3d> expressions =
      compress::readExpressionMeshes(capture, "its mesh, to learn from", progress);
  const Eigen::MatrixX3d still = scale * meshes.neutral.positions;
  geometry::Similarity motion;
  if (frame.rows() > 0) motion = geometry::fitSimilarity(still, frame, {}, /* fixed_scale= */ true);
  for (const Eigen::MatrixX3d& expression : expressions) {
    meshes.displacements.push_back(motion.applyToVectors(scale * expression - still).cast<float>());
  }
  meshes.neutral.positions = motion.apply(still);
  return meshes;
}

}  // namespace facezip::learn
