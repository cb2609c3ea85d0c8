// rig_template.hpp - the shapes that a rig is made of, from disk.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "facezip/geometry/mesh.hpp"

namespace facezip::rig {

struct RigTemplate {
  std::filesystem::path neutral_file;
  geometry::TriangleMesh neutral;
  std::vector<std::string> names;        ///< M, sorted
  std::vector<Eigen::MatrixX3d> shapes;  ///< M positions, as many rows as the neutral has vertices
};

/// Reads neutral.obj (or generic_neutral.obj) and every other OBJ file of a directory as a shape of that name.
/// Throws InputError: no directory, no or two neutrals, no shape, a shape of another topology than the neutral, a name
/// that a package cannot hold.
RigTemplate readTemplate(const std::filesystem::path& directory);

/// Checks that the template begins with the subject's mesh: its first vertices and triangles are those of `mesh`.
/// Throws InputError naming the first difference.
void requireSkin(const RigTemplate& rig_template, const geometry::TriangleMesh& mesh, const std::string& mesh_file);

}  // namespace facezip::rig
