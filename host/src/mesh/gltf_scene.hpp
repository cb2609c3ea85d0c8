// gltf_scene.hpp - a face as glTF 2.0: its neutral mesh, named morph targets and the neutral's textures.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "facezip/geometry/mesh.hpp"
#include "mesh/package_mesh.hpp"

namespace facezip::mesh {

/// One expression or shape.
struct MorphTarget {
  std::string name;
  Eigen::MatrixX3d positions;  ///< #V by 3, absolute, the neutral's vertices in its unit
};

/// More triangles of a scene's mesh, with a material of their own. Its texture's path is relative to the file.
struct ScenePart {
  Eigen::MatrixX3i triangles;     ///< of the neutral's positions
  Eigen::MatrixX3i uv_triangles;  ///< of its UVs; 0 rows without
  PackageMaterial material;
};

/// What writeGltf() writes.
struct GltfScene {
  std::string name;                  ///< of mesh and node
  geometry::TriangleMesh neutral;    ///< with or without UVs; without triangles where there are parts alone
  std::vector<ScenePart> parts;      ///< each a primitive, behind that of the neutral's triangles
  std::vector<MorphTarget> targets;  ///< weights start at 0; names go to mesh.extras.targetNames, where tools look
  double metres_per_unit = 1.0;      ///< glTF is in metres
  /// That was taken from all positions, in their unit: recorded in mesh.extras.origin, in metres, where it is not zero.
  Eigen::RowVector3d origin = Eigen::RowVector3d::Zero();
  std::string base_colour_texture;      ///< path relative to the file, "" for none
  std::string normal_texture;           ///< likewise; tangent space, +y up, as glTF asks
  nlohmann::json material_extras = {};  ///< an object, or null for none
};

/// The vertices that a GPU needs: one for each pair of position and UV that a corner uses, by rising position, then UV.
/// A mesh without UV seams whose vertices are all used keeps its numbers.
struct SplitVertices {
  std::vector<int> positions;  ///< split vertex -> row of positions
  std::vector<int> uvs;        ///< split vertex -> row of uvs; -1 without UVs
  std::vector<int> corners;    ///< 3 per triangle, split vertices
};
/// uv_triangles  0 rows without UVs
SplitVertices splitVertices(const Eigen::MatrixX3i& triangles, const Eigen::MatrixX3i& uv_triangles);

/// Unit normals of the vertices, #V by 3, weighted by the areas of their triangles; (0, 0, 1) where that is no
/// direction.
Eigen::MatrixX3d vertexNormals(const Eigen::MatrixX3d& positions, const Eigen::MatrixX3i& triangles);

/// Takes geometry::floatOrigin() of the neutral from all positions, and returns it.
Eigen::RowVector3d recentre(GltfScene& scene);
/// Takes this origin from them: of the mesh that a scene's parts belong to.
void recentre(GltfScene& scene, const Eigen::RowVector3d& origin);

/// Writes one mesh of one primitive or more, with normals, UVs (v down, as glTF has them) and morph targets of
/// positions and normals; targets that move less than half of the vertices are stored sparsely. `.glb` gives one file;
/// `.gltf` gives NAME.bin beside it. Textures are referred to, not copied. The files may be part of an
/// io::StagedDirectory: nothing is staged here. Throws OutputError; InputError naming a target with another number of
/// vertices.
void writeGltf(const std::filesystem::path& file, const GltfScene& scene);

/// Material of a glTF file.
struct GltfMaterial {
  std::string base_colour_texture;  ///< path relative to the file, "" for none
  std::string normal_texture;       ///< likewise
  std::string roughness_texture;    ///< likewise
  std::string occlusion_texture;    ///< likewise
  nlohmann::json extras;            ///< an object, or null for none
};

/// Parts of a head that a scene shows beside its skin.
struct GltfParts {
  PackageMesh mesh;
  std::vector<PackageMaterial> materials;  ///< with textures by their paths relative to the scene
};

/// Writes the mesh of a package to `to` (.gltf, with NAME.bin beside it) with this material, and its parts as further
/// primitives of the same mesh: one set of weights moves all. parts  null for none. Throws OutputError.
void addBlendToGltf(const PackageMesh& mesh, const GltfParts* parts, const std::filesystem::path& to,
                    const GltfMaterial& material);

}  // namespace facezip::mesh
