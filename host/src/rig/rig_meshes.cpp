#include "rig/rig_meshes.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>

#include "capture/capture_meshes.hpp"
#include "face/face.hpp"
#include "facezip/geometry/obj_io.hpp"
#include "facezip/geometry/part_transfer.hpp"
#include "facezip/package.hpp"
#include "io/staged_directory.hpp"
#include "mesh/gltf_scene.hpp"
#include "mesh/map_roles.hpp"
#include "package/guides.hpp"

namespace facezip::rig {
namespace {

geometry::LengthUnit unitOf(const Capture& capture, const RigOptions& options, const geometry::TriangleMesh& mesh,
                            Progress& progress) {
  const std::string stated = options.compress.unit.value_or(capture.unit);
  if (!stated.empty()) return geometry::parseUnit(stated);
  try {
    const geometry::UnitGuess guess = geometry::guessUnit(mesh);
    progress.note(guess.explanation);
    return guess.unit;
  } catch (const InputError& error) {
    throw error.in(capture.neutral_mesh.string());
  }
}

/// Skin and parts in one mesh. Parts keep the template's UVs where it has any.
geometry::TriangleMesh wholeNeutral(const geometry::TriangleMesh& skin, const geometry::TriangleMesh& whole,
                                    const Eigen::MatrixX3d& parts) {
  geometry::TriangleMesh mesh;
  mesh.positions.resize(skin.positions.rows() + parts.rows(), 3);
  mesh.positions << skin.positions, parts;
  mesh.triangles = whole.triangles;
  const Eigen::Index beyond = whole.triangles.rows() - skin.triangles.rows();
  const bool has_uvs = whole.uv_triangles.rows() > 0;
  // Without UVs of their own parts share one, behind the skin's.
  mesh.uvs.resize(skin.uvs.rows() + (has_uvs ? whole.uvs.rows() : 1), 2);
  mesh.uvs.topRows(skin.uvs.rows()) = skin.uvs;
  if (has_uvs) {
    mesh.uvs.bottomRows(whole.uvs.rows()) = whole.uvs;
  } else {
    mesh.uvs.bottomRows(1).setZero();
  }
  mesh.uv_triangles.resize(whole.triangles.rows(), 3);
  mesh.uv_triangles.topRows(skin.triangles.rows()) = skin.uv_triangles;
  const auto first = static_cast<int>(skin.uvs.rows());
  for (Eigen::Index t = whole.triangles.rows() - beyond; t < whole.triangles.rows(); ++t) {
    for (int corner = 0; corner < 3; ++corner) {
      mesh.uv_triangles(t, corner) = first + (has_uvs ? whole.uv_triangles(t, corner) : 0);
    }
  }
  return mesh;
}

std::string neutralOf(const std::vector<PackageMap>& maps, mesh::MapRole role) {
  const std::vector<mesh::MapRole> roles = mesh::rolesOf(maps);
  const auto found = std::ranges::find(roles, role);
  if (found == roles.end()) return "";
  const std::string& file = maps[static_cast<std::size_t>(found - roles.begin())].neutral_file;
  return file.ends_with(".png") ? file : "";  // glTF takes no other
}

}  // namespace

RigSubject readSubject(const Capture& capture, const RigOptions& options, Progress& progress) {
  RigSubject subject;
  subject.neutral = CaptureMeshes(capture).neutral();
  subject.expressions = compress::readExpressionMeshes(capture, "its mesh, to fit the rig to", progress);
  subject.unit = unitOf(capture, options, subject.neutral, progress);
  return subject;
}

RigFace assembleFace(const RigSubject& subject, const RigTemplate& rig_template, const geometry::ExampleRig& rig) {
  RigFace face;
  const Eigen::Index skin = subject.neutral.positions.rows();
  const Eigen::Index total = rig_template.neutral.positions.rows();
  if (total == skin) {
    face.neutral = subject.neutral;
    for (const Eigen::MatrixX3d& shape : rig.shapes) face.shapes.emplace_back(subject.neutral.positions + shape);
    return face;
  }
  const geometry::Parts parts =
      geometry::transferParts({skin, rig_template.neutral.triangles, rig_template.neutral.positions,
                               rig_template.shapes, subject.neutral.positions, rig.transferred, rig.shapes});
  face.parts = parts.count;
  face.neutral = wholeNeutral(subject.neutral, rig_template.neutral, parts.neutral);
  for (std::size_t m = 0; m < rig.shapes.size(); ++m) {
    Eigen::MatrixX3d positions = face.neutral.positions;
    positions.topRows(skin) += rig.shapes[m];
    positions.bottomRows(total - skin) += parts.shapes[m];
    face.shapes.push_back(std::move(positions));
  }
  return face;
}

void writeFace(const std::filesystem::path& directory, const RigFace& face, const std::vector<std::string>& names,
               const std::string& title, double metres_per_unit, const std::vector<PackageMap>& maps) {
  io::createDirectories(directory / "shapes");
  geometry::writeObj(directory / "shapes" / "neutral.obj", face.neutral);
  tbb::parallel_for(std::size_t{0}, names.size(), [&](std::size_t m) {
    geometry::TriangleMesh shape = face.neutral;
    shape.positions = face.shapes[m];
    geometry::writeObj(directory / "shapes" / (names[m] + ".obj"), shape);
  });
  mesh::GltfScene scene;
  scene.name = title;
  scene.neutral = face.neutral;
  for (std::size_t m = 0; m < names.size(); ++m) scene.targets.push_back({names[m], face.shapes[m]});
  scene.metres_per_unit = metres_per_unit;
  scene.base_colour_texture = neutralOf(maps, mesh::MapRole::kAlbedo);
  scene.normal_texture = neutralOf(maps, mesh::MapRole::kNormal);
  mesh::recentre(scene);
  mesh::writeGltf(directory / "rig.gltf", scene);
}

void writePackageMesh(const std::filesystem::path& directory, const RigSubject& subject,
                      const geometry::ExampleRig& rig, const std::vector<std::string>& expressions,
                      const std::vector<std::string>& shapes, const std::string& title) {
  mesh::GltfScene scene;
  scene.name = title.empty() ? "face" : title;
  scene.neutral = subject.neutral;
  scene.metres_per_unit = geometry::metresPerUnit(subject.unit);
  for (std::size_t n = 0; n < expressions.size(); ++n) {
    scene.targets.push_back({expressions[n], subject.expressions[n]});
  }
  for (std::size_t m = 0; m < shapes.size(); ++m) {
    scene.targets.push_back({shapes[m], subject.neutral.positions + rig.shapes[m]});
  }
  mesh::recentre(scene);
  mesh::writeGltf(directory / package::kMeshFile, scene);
}

}  // namespace facezip::rig
