// rig_template.hpp - the shapes that a rig is made of, from disk.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "facezip/geometry/mesh.hpp"
#include "facezip/progress.hpp"
#include "rig/template_parts.hpp"

namespace facezip::rig {

struct RigTemplate {
  std::filesystem::path neutral_file;
  geometry::TriangleMesh neutral;
  std::vector<std::string> names;        ///< M, sorted
  std::vector<Eigen::MatrixX3d> shapes;  ///< M positions, as many rows as the neutral has vertices
  TemplateParts parts;                   ///< beyond a skin: readTemplateParts()
};

/// Reads neutral.obj (generic_neutral.obj, generic_neutral_mesh.obj) and every other OBJ file of a directory as a shape
/// of that name, but for the neutrals of others (identity042.obj). Files that hold displacements of the neutral, not
/// positions, are told by their size, and added to it.
/// progress  notes which files are not taken, and which are displacements
/// Throws InputError: no directory, no or two neutrals, no shape, a shape of another topology than the neutral, a name
/// that a package cannot hold, or two files of one name.
RigTemplate readTemplate(const std::filesystem::path& directory, Progress& progress);

/// Checks that the template begins with the subject's mesh: its first vertices and triangles are those of `mesh`.
/// Throws InputError naming the first difference.
void requireSkin(const RigTemplate& rig_template, const geometry::TriangleMesh& mesh, const std::string& mesh_file);

}  // namespace facezip::rig
