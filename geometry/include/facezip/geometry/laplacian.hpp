// laplacian.hpp - the combinatorial Laplacian of a mesh (FaceZip 3.1, Mask Computation).
#pragma once

#include <Eigen/SparseCore>

#include "facezip/geometry/face_region.hpp"

namespace facezip::geometry {

/// Degree minus adjacency of the graph of the triangles' edges, #V by #V: symmetric, positive semidefinite, rows sum to
/// 0 exactly. It knows no lengths or angles, so slivers, zero areas and non-manifold edges do no harm: an edge
/// counts once however many triangles share it, an edge from a vertex to itself not at all.
Eigen::SparseMatrix<double> combinatorialLaplacian(const RegionMesh& region);

}  // namespace facezip::geometry
