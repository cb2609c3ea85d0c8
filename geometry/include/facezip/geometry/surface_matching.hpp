// surface_matching.hpp - which points of a mesh the points of a scan belong to.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "facezip/geometry/closest_surface.hpp"
#include "facezip/geometry/surface_deformation.hpp"

namespace facezip::geometry {

/// What a scan says of a surface: points with normals, each for some area of it.
struct ScanPoints {
  Eigen::MatrixX3d positions;  ///< #P by 3
  Eigen::MatrixX3d normals;    ///< #P by 3, of length 1
  Eigen::VectorXd areas;       ///< #P, in the square of the unit; 0 for points that are not believed in

  Eigen::Index size() const { return positions.rows(); }
};

struct MatchOptions {
  double kernel = 1.0;        ///< distance at which a match counts a quarter (Geman-McClure), in the unit of the mesh
  double least_cosine = 0.5;  ///< between the normals of both surfaces
  double reach = 10.0;        ///< matches farther than this are none
};

/// The part of a template that scans show: some of its triangles.
struct MatchedSurface {
  Eigen::MatrixX3i triangles;  ///< #T by 3, of the mesh's vertices
  std::vector<bool> used;      ///< #T
};

/// Point to plane targets: for each point of the scan the closest point of the mesh that faces as it does is drawn to
/// it along the mean of both normals. Points of the scan, not of the mesh, ask: they lie on the skin, all of them,
/// whereas the vertices of a mesh stick out where the skin is bent more than its triangles, and would be drawn in.
/// Points whose closest is on the mesh's border are nobody's, the scan goes on where the mesh ends; those without a
/// match give none. positions  #V by 3, of the mesh as it is hints      triangles that the points matched last, empty
/// at first; those of this time come back
std::vector<PointTarget> matchSurface(const ScanPoints& scan, const MatchedSurface& surface,
                                      const Eigen::MatrixX3d& positions, const MatchOptions& options,
                                      std::vector<int>& hints);

/// A point of a mesh and how much of its surface it stands for.
struct MeshSample {
  Eigen::RowVector3i vertices;
  Eigen::RowVector3d barycentric;
  double area = 0.0;
};

/// Samples of the used triangles: their corners and their centres, half of the area each.
std::vector<MeshSample> sampleMesh(const Eigen::MatrixX3d& positions, const MatchedSurface& surface);

/// The other way about: each sample is drawn to the closest point of the scan that faces as it does, if that is not on
/// the scan's border. Reaches what no point of the scan asks for: folds that are deeper in the mesh than in the scan.
/// trust  #T of the scan's triangles, 0..1
std::vector<PointTarget> matchSamples(const std::vector<MeshSample>& samples, const ClosestSurface& scan,
                                      const std::vector<float>& trust, const MatchedSurface& surface,
                                      const Eigen::MatrixX3d& positions, const MatchOptions& options,
                                      std::vector<int>& hints);

}  // namespace facezip::geometry
