#include "rig/rig_meshes.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>

#include "capture/capture_meshes.hpp"
#include "face/face.hpp"
#include "facezip/geometry/float_origin.hpp"
#include "facezip/geometry/obj_io.hpp"
#include "facezip/geometry/part_transfer.hpp"
#include "facezip/package.hpp"
#include "io/staged_directory.hpp"
#include "mesh/gltf_scene.hpp"
#include "mesh/map_roles.hpp"
#include "package/guides.hpp"
#include "package/package_json.hpp"
#include "rig/part_paint.hpp"

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

/// The texture's file, and what package.json says of it.
void nameTexture(TemplatePart& part) {
  if (part.texture.samples.empty()) return;
  part.material.texture = fmt::format("parts/{}.png", part.material.name);
  part.material.width = part.texture.shape.width;
  part.material.height = part.texture.shape.height;
  part.material.channels = part.texture.shape.channels;
}

/// Rows of the face's triangles that are of a part.
std::vector<Eigen::Index> trianglesOf(const RigFace& face, int part) {
  std::vector<Eigen::Index> rows;
  for (std::size_t i = 0; i < face.parts.of_triangle.size(); ++i) {
    if (face.parts.of_triangle[i] == part) rows.push_back(face.skin_triangles + static_cast<Eigen::Index>(i));
  }
  return rows;
}

std::vector<mesh::ScenePart> scenePartsOf(const RigFace& face) {
  std::vector<mesh::ScenePart> parts;
  for (std::size_t p = 0; p < face.parts.parts.size(); ++p) {
    const std::vector<Eigen::Index> rows = trianglesOf(face, static_cast<int>(p));
    mesh::ScenePart part{face.neutral.triangles(rows, Eigen::all), {}, face.parts.parts[p].material};
    part.uv_triangles = face.neutral.uv_triangles(rows, Eigen::all);
    parts.push_back(std::move(part));
  }
  return parts;
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

RigFace assembleFace(const RigSubject& subject, const RigTemplate& rig_template, const geometry::ExampleRig& rig,
                     const std::string& eyes) {
  RigFace face;
  const Eigen::Index skin = subject.neutral.positions.rows();
  face.skin_vertices = skin;
  face.skin_triangles = subject.neutral.triangles.rows();
  const Eigen::Index total = rig_template.neutral.positions.rows();
  if (total == skin) {
    face.neutral = subject.neutral;
    for (const Eigen::MatrixX3d& shape : rig.shapes) face.shapes.emplace_back(subject.neutral.positions + shape);
    return face;
  }
  const PartGroups groups = groupParts(rig_template.parts, rig_template.neutral, skin, face.skin_triangles);
  const geometry::Parts parts = geometry::transferParts(
      {skin, rig_template.neutral.triangles, rig_template.neutral.positions, rig_template.shapes,
       subject.neutral.positions, rig.transferred, rig.shapes, groups.of_vertex, groups.on_skin});
  face.pieces = parts.count;
  face.parts = rig_template.parts;
  face.neutral = wholeNeutral(subject.neutral, rig_template.neutral, parts.neutral);
  const PartScene scene{rig_template.neutral.positions, skin, face.skin_triangles, groups};
  paintParts(scene, findIris(eyes, "--eyes"), !eyes.empty(), face.neutral, face.parts);
  for (TemplatePart& part : face.parts.parts) nameTexture(part);
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
  scene.neutral.triangles.conservativeResize(face.skin_triangles, 3);
  scene.neutral.uv_triangles.conservativeResize(face.skin_triangles, 3);
  scene.parts = scenePartsOf(face);
  for (const TemplatePart& part : face.parts.parts) {
    if (part.texture.samples.empty()) continue;
    io::createDirectories(directory / "parts");
    image::writeImage(directory / part.material.texture, part.texture, "sRGB");
  }
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

void writePackageParts(const std::filesystem::path& directory, const RigFace& face,
                       const std::vector<Eigen::MatrixX3d>& expressions, const Eigen::MatrixXd& weights,
                       double metres_per_unit) {
  if (face.parts.empty()) return;
  const Package package = Package::open(directory);
  PackageDescription description = package.description();
  mesh::GltfScene scene;
  scene.name = "parts";
  scene.neutral.positions = face.neutral.positions;
  scene.neutral.uvs = face.neutral.uvs;
  scene.metres_per_unit = metres_per_unit;
  scene.parts = scenePartsOf(face);
  description.parts = {package::kPartsFile, {}};
  for (mesh::ScenePart& part : scene.parts) {
    description.parts->materials.push_back(part.material);
    part.material.texture.clear();  // a package's meshes refer to no file: package.json does
  }
  const std::vector<std::string>& names = description.expressions;
  for (std::size_t n = 0; n < expressions.size(); ++n) {
    Eigen::MatrixX3d positions = face.neutral.positions;
    for (std::size_t m = 0; m < face.shapes.size(); ++m) {
      const double weight = weights(static_cast<Eigen::Index>(n), static_cast<Eigen::Index>(m));
      if (weight != 0.0) positions += weight * (face.shapes[m] - face.neutral.positions);
    }
    positions.topRows(face.skin_vertices) = expressions[n];
    scene.targets.push_back({names[n], std::move(positions)});
  }
  for (std::size_t m = 0; m < face.shapes.size(); ++m) {
    scene.targets.push_back({names[expressions.size() + m], face.shapes[m]});
  }
  // Near the origin as the mesh of the skin is.
  mesh::recentre(scene, geometry::floatOrigin(face.neutral.positions.topRows(face.skin_vertices)));
  mesh::writeGltf(directory / package::kPartsFile, scene);
  io::writeTextFile(directory / package::kDescriptionFile, package::packageJson(description));
}

}  // namespace facezip::rig
