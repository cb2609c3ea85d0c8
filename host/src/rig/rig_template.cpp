#include "rig/rig_template.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <iterator>

#include "facezip/error.hpp"
#include "facezip/geometry/obj_io.hpp"
#include "facezip/geometry/topology.hpp"
#include "package/safe_names.hpp"

namespace facezip::rig {
namespace fs = std::filesystem;
namespace {

bool isNeutral(const std::string& name) { return name == "neutral" || name == "generic_neutral"; }

std::vector<fs::path> templateFiles(const fs::path& directory) {
  std::error_code error;
  if (fs::is_directory(directory, error)) return geometry::objFiles(directory);
  throw InputError({directory.string(), "template", "a directory with neutral.obj and an OBJ file for each shape",
                    fs::exists(directory, error) ? "a file" : "no such directory", ""});
}

void requireName(const std::string& name, const fs::path& file) {
  const auto fault = package::nameFault(name, ",=:");
  if (fault) throw InputError({file.string(), "shape", fault->expected, fault->got, "rename the file"});
}

}  // namespace

RigTemplate readTemplate(const fs::path& directory) {
  RigTemplate found;
  std::vector<fs::path> shape_files;
  for (const fs::path& file : templateFiles(directory)) {
    if (!isNeutral(file.stem().string())) {
      requireName(file.stem().string(), file);
      found.names.push_back(file.stem().string());
      shape_files.push_back(file);
      continue;
    }
    if (!found.neutral_file.empty()) {
      throw InputError({directory.string(), "template", "one neutral",
                        found.neutral_file.filename().string() + " and " + file.filename().string(), "remove one"});
    }
    found.neutral_file = file;
  }
  if (found.neutral_file.empty()) {
    throw InputError({directory.string(), "template", "neutral.obj or generic_neutral.obj", "neither", ""});
  }
  if (shape_files.empty()) {
    throw InputError({directory.string(), "template", "an OBJ file for each shape beside the neutral", "none", ""});
  }
  found.neutral = geometry::readObj(found.neutral_file);
  found.shapes.resize(shape_files.size());
  tbb::parallel_for(std::size_t{0}, shape_files.size(), [&](std::size_t m) {
    const geometry::TriangleMesh shape = geometry::readObj(shape_files[m]);
    geometry::requireSameTopology(found.neutral, found.neutral_file.string(), shape, shape_files[m].string());
    found.shapes[m] = shape.positions;
  });
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
