#include "rig/rig_template.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <iterator>

#include "capture/mesh_names.hpp"
#include "facezip/error.hpp"
#include "facezip/geometry/obj_io.hpp"
#include "facezip/geometry/topology.hpp"
#include "io/composed.hpp"
#include "io/quoted.hpp"
#include "io/safe_names.hpp"
#include "scene/morph_mesh.hpp"

namespace facezip::rig {
namespace fs = std::filesystem;
namespace {

std::vector<fs::path> templateFiles(const fs::path& directory) {
  std::error_code error;
  if (fs::is_directory(directory, error)) return geometry::objFiles(directory);
  throw InputError({directory.string(), "template", "a directory with neutral.obj and an OBJ file for each shape",
                    fs::exists(directory, error) ? "a file" : "no such directory", ""});
}

void requireName(const std::string& name, const fs::path& file) {
  const auto fault = io::nameFault(name, ",=:");
  if (fault) throw InputError({file.string(), "shape", fault->expected, fault->got, "rename the file"});
}

/// The OBJ files of a template.
struct TemplateFiles {
  fs::path neutral;
  std::vector<std::string> names;
  std::vector<fs::path> shapes;
  std::size_t identities = 0;
};

TemplateFiles sortFiles(const fs::path& directory) {
  TemplateFiles files;
  for (const fs::path& file : templateFiles(directory)) {
    const std::string name = io::composed(file.stem().string());
    if (isIdentityMesh(name)) {
      ++files.identities;
      continue;
    }
    if (!isNeutralMesh(name)) {
      requireName(name, file);
      if (std::ranges::find(files.names, name) != files.names.end()) {
        throw InputError({file.string(), "shape", "one file of each name", io::quoted(name) + " twice",
                          "remove one of those that are spelt alike"});
      }
      files.names.push_back(name);
      files.shapes.push_back(file);
      continue;
    }
    if (!files.neutral.empty()) {
      throw InputError({directory.string(), "template", "one neutral",
                        files.neutral.filename().string() + " and " + file.filename().string(), "remove one"});
    }
    files.neutral = file;
  }
  if (files.neutral.empty()) {
    throw InputError({directory.string(), "template", "neutral.obj, generic_neutral.obj or generic_neutral_mesh.obj",
                      "none of them", ""});
  }
  if (files.shapes.empty()) {
    throw InputError({directory.string(), "template", "an OBJ file for each shape beside the neutral", "none", ""});
  }
  return files;
}

double medianLength(const Eigen::MatrixX3d& vectors) {
  std::vector<double> lengths(static_cast<std::size_t>(vectors.rows()));
  for (std::size_t v = 0; v < lengths.size(); ++v) lengths[v] = vectors.row(static_cast<Eigen::Index>(v)).norm();
  const auto middle = lengths.begin() + std::ssize(lengths) / 2;
  std::nth_element(lengths.begin(), middle, lengths.end());
  return *middle;
}

/// Are these displacements? Half of a face or more hardly moves, so they are short, where positions are as far from the
/// origin as the neutral's.
bool isDisplacement(const Eigen::MatrixX3d& shape, const Eigen::MatrixX3d& neutral) {
  const double size = medianLength(neutral);
  return medianLength(shape) < 0.1 * size && medianLength(shape - neutral) > 0.5 * size;
}

void noteFiles(const fs::path& directory, const TemplateFiles& files, std::size_t displacements, Progress& progress) {
  if (files.identities > 0) {
    progress.note(fmt::format("{}: identityNNN.obj ({} of them) are no shapes", directory.string(), files.identities));
  }
  if (displacements > 0) {
    progress.note(fmt::format("{}: {} of {} shapes hold displacements, not positions: added to the neutral",
                              directory.string(), displacements, files.shapes.size()));
  }
}

/// A template whose shapes are morph targets of one file.
RigTemplate fromMorphs(const fs::path& file, Progress& progress) {
  scene::MorphMesh morphs = scene::readMorphMesh(file, "");
  if (!morphs.note.empty()) progress.note(morphs.note);
  RigTemplate found;
  found.neutral_file = file;
  found.neutral = std::move(morphs.neutral);
  for (auto& [name, positions] : morphs.positions) {
    requireName(name, file);
    found.names.push_back(name);
    found.shapes.push_back(std::move(positions));
  }
  if (!found.names.empty()) return found;
  throw InputError({file.string(), "template", "morph targets, the shapes", "none", ""});
}

}  // namespace

RigTemplate readTemplate(const fs::path& directory, Progress& progress) {
  if (templateFiles(directory).empty()) {
    const fs::path file = scene::sceneFileIn(directory, "remove one");
    if (!file.empty()) return fromMorphs(file, progress);
  }
  const TemplateFiles files = sortFiles(directory);
  RigTemplate found;
  found.neutral_file = files.neutral;
  found.names = files.names;
  found.neutral = geometry::readObj(found.neutral_file);
  found.shapes.resize(files.shapes.size());
  std::atomic<std::size_t> displacements = 0;
  tbb::parallel_for(std::size_t{0}, files.shapes.size(), [&](std::size_t m) {
    const geometry::TriangleMesh shape = geometry::readObj(files.shapes[m]);
    geometry::requireSameTopology(found.neutral, found.neutral_file.string(), shape, files.shapes[m].string());
    found.shapes[m] = shape.positions;
    if (!isDisplacement(shape.positions, found.neutral.positions)) return;
    found.shapes[m] += found.neutral.positions;
    ++displacements;
  });
  noteFiles(directory, files, displacements, progress);
  return found;
}

void requireSkin(const RigTemplate& rig_template, const geometry::TriangleMesh& mesh, const std::string& mesh_file) {
  const geometry::TriangleMesh& whole = rig_template.neutral;
  geometry::TriangleMesh skin;  // the first vertices and triangles; UVs are the capture's
  skin.positions = whole.positions.topRows(std::min(whole.positions.rows(), mesh.positions.rows()));
  skin.triangles = whole.triangles.topRows(std::min(whole.triangles.rows(), mesh.triangles.rows()));
  skin.polygons.assign(whole.polygons.begin(),
                       whole.polygons.begin() + std::min(std::ssize(whole.polygons), skin.triangles.rows()));
  geometry::requireSameTopology(mesh, mesh_file, skin, rig_template.neutral_file.string());
  for (Eigen::Index t = skin.triangles.rows(); t < whole.triangles.rows(); ++t) {
    if (whole.triangles.row(t).maxCoeff() >= mesh.positions.rows()) continue;
    throw InputError({rig_template.neutral_file.string(), fmt::format("triangle {} (counted from 0)", t),
                      fmt::format("a part beyond the {} vertices of {}", mesh.positions.rows(), mesh_file),
                      "a triangle of the skin alone", "use a template of the capture's topology"});
  }
}

}  // namespace facezip::rig
