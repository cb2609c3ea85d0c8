// scene_mesh.hpp - the meshes of a file that holds scenes: glTF, FBX.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace facezip::scene {

/// A morph target.
struct SceneShape {
  std::string name;                         ///< as the file spells it; "" where it has none
  std::vector<Eigen::RowVector3d> offsets;  ///< one a vertex, of the placed mesh
};

/// A mesh where the nodes of its scene place it. Vertices are the file's, split wherever it has seams.
struct SceneMesh {
  std::string name;  ///< of its node, else of the mesh
  std::vector<Eigen::RowVector3d> positions;
  std::vector<Eigen::RowVector2d> uvs;  ///< one a vertex, v up; empty where the file has none
  std::vector<Eigen::RowVector3i> triangles;
  std::vector<int> materials;  ///< of each triangle, from 0; as many as the file has: of none
  std::vector<int> polygons;   ///< of each triangle: which face of the file it is part of, rising
  std::vector<SceneShape> shapes;
};

/// Bounds of what files of strangers may hold, all meshes together.
inline constexpr std::size_t kMostVertices = std::size_t{1}
                                             << 25;                // and triangles; nodes may place one mesh many times
inline constexpr std::size_t kMostOffsets = std::size_t{1} << 26;  // 1.6 GB

}  // namespace facezip::scene
