#include "register/registration_template.hpp"

#include <tbb/parallel_for.h>

#include "facezip/error.hpp"
#include "facezip/geometry/face_region.hpp"
#include "facezip/geometry/obj_io.hpp"
#include "facezip/geometry/topology.hpp"

namespace facezip::registration {
namespace fs = std::filesystem;
namespace {

bool isNeutral(const fs::path& file) { return file.stem() == "neutral" || file.stem() == "generic_neutral"; }

std::vector<fs::path> filesOf(const fs::path& directory) {
  std::error_code error;
  if (fs::is_directory(directory, error)) return geometry::objFiles(directory);
  throw InputError({directory.string(), "template", "a directory with neutral.obj and landmarks.json",
                    fs::exists(directory, error) ? "a file" : "no such directory", ""});
}

/// The neutral's file, taken out of `files`.
fs::path takeNeutral(const fs::path& directory, std::vector<fs::path>& files) {
  std::vector<fs::path> neutrals;
  for (const fs::path& file : files) {
    if (isNeutral(file)) neutrals.push_back(file);
  }
  if (neutrals.size() != 1) {
    throw InputError({directory.string(), "template", "neutral.obj or generic_neutral.obj",
                      neutrals.empty() ? "neither" : "both", neutrals.empty() ? "" : "remove one"});
  }
  std::erase_if(files, isNeutral);
  return neutrals.front();
}

std::vector<Eigen::MatrixX3d> readDisplacements(const RegistrationTemplate& whole, const std::vector<fs::path>& files) {
  std::vector<Eigen::MatrixX3d> displacements(files.size());
  tbb::parallel_for(std::size_t{0}, files.size(), [&](std::size_t i) {
    const geometry::TriangleMesh mesh = geometry::readObj(files[i]);
    geometry::requireSameTopology(whole.neutral, whole.neutral_file.string(), mesh, files[i].string());
    displacements[i] = mesh.positions - whole.neutral.positions;
  });
  return displacements;
}

}  // namespace

RegistrationTemplate readRegistrationTemplate(const fs::path& directory) {
  std::vector<fs::path> shape_files = filesOf(directory);
  RegistrationTemplate found;
  found.neutral_file = takeNeutral(directory, shape_files);
  found.neutral = geometry::readObj(found.neutral_file);
  geometry::requireUvs(found.neutral, found.neutral_file.string());
  found.landmarks =
      readTemplateLandmarks(directory / "landmarks.json", static_cast<int>(found.neutral.positions.rows()));
  found.shapes = readDisplacements(found, shape_files);
  std::error_code error;
  if (fs::is_directory(directory / "identity", error)) {
    found.identity = readDisplacements(found, geometry::objFiles(directory / "identity"));
  }
  if (fs::exists(directory / "face_region.txt", error)) {
    found.region =
        geometry::readTriangleIndices(directory / "face_region.txt", static_cast<int>(found.neutral.triangles.rows()));
  }
  return found;
}

}  // namespace facezip::registration
