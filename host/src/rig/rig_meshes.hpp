// rig_meshes.hpp - the meshes of a rig: the subject's, the template's, and the whole face that comes of them.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <vector>

#include "facezip/capture.hpp"
#include "facezip/geometry/example_rig.hpp"
#include "facezip/geometry/length.hpp"
#include "facezip/package.hpp"
#include "facezip/progress.hpp"
#include "facezip/rig.hpp"
#include "rig/rig_template.hpp"

namespace facezip::rig {

/// What a rig is fitted to.
struct RigSubject {
  geometry::TriangleMesh neutral;
  std::vector<Eigen::MatrixX3d> expressions;  ///< N positions
  geometry::LengthUnit unit = geometry::LengthUnit::kMetre;

  double millimetresPerUnit() const { return 1000.0 * geometry::metresPerUnit(unit); }
};

/// Reads the neutral and every expression's mesh, and finds their unit.
/// Throws InputError: an expression without mesh or of another topology, a unit that cannot be guessed.
RigSubject readSubject(const Capture& capture, const RigOptions& options, Progress& progress);

/// The rig's face: the subject's skin, and the template's parts beyond it where the subject's skin wants them.
struct RigFace {
  geometry::TriangleMesh neutral;        ///< the skin, then the parts
  std::vector<Eigen::MatrixX3d> shapes;  ///< M positions
  Eigen::Index skin_vertices = 0;
  Eigen::Index skin_triangles = 0;
  TemplateParts parts;  ///< all with the textures that they shall have
  int pieces = 0;       ///< beyond the skin, that are placed for themselves
};

/// eyes  iris of the eyes, as findIris() takes it; "": the template's texture, or where it has none the first choice
RigFace assembleFace(const RigSubject& subject, const RigTemplate& rig_template, const geometry::ExampleRig& rig,
                     const std::string& eyes);

/// Writes shapes/neutral.obj, shapes/NAME.obj, textures of parts and rig.gltf into the directory of a package.
/// maps  names of the package's maps and their neutral files, for the glTF's textures
void writeFace(const std::filesystem::path& directory, const RigFace& face, const std::vector<std::string>& names,
               const std::string& title, double metres_per_unit, const std::vector<PackageMap>& maps);

/// Writes the package's mesh.glb anew: the subject's skin, posed by each of its expressions and then by each shape.
/// expressions, shapes  N + M names, as the package has them
void writePackageMesh(const std::filesystem::path& directory, const RigSubject& subject,
                      const geometry::ExampleRig& rig, const std::vector<std::string>& expressions,
                      const std::vector<std::string>& shapes, const std::string& title);

/// Writes parts.glb, the face's parts as each expression and each shape of the package's mesh moves them, and adds them
/// to package.json. Nothing where it has none.
/// expressions  N positions of the skin;  weights  N by M, of the shapes that pose them. None of a neutral alone.
void writePackageParts(const std::filesystem::path& directory, const RigFace& face,
                       const std::vector<Eigen::MatrixX3d>& expressions, const Eigen::MatrixXd& weights,
                       double metres_per_unit);

}  // namespace facezip::rig
