// closest_surface.hpp - where on a surface a point belongs: closest points that face the right way.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <memory>
#include <span>
#include <vector>

namespace facezip::geometry {

/// A point of a triangle mesh.
struct SurfacePoint {
  int triangle = -1;  ///< -1: none was found
  Eigen::Vector3d barycentric = Eigen::Vector3d::Zero();
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  double distance = std::numeric_limits<double>::infinity();

  bool found() const { return triangle >= 0; }
};

/// Answers closest point queries on one mesh, through a tree of bounding boxes (CGAL). Queries may run side by side.
class ClosestSurface {
 public:
  /// positions  #V by 3, finite
  /// triangles  #T by 3, T >= 1; triangles without area are never found
  /// used       #T, false for triangles that are never found; empty: all are used
  ClosestSurface(const Eigen::MatrixX3d& positions, const Eigen::MatrixX3i& triangles, std::vector<bool> used = {});
  ~ClosestSurface();
  ClosestSurface(ClosestSurface&&) noexcept;
  ClosestSurface& operator=(ClosestSurface&&) noexcept;

  /// The closest point within `reach`.
  SurfacePoint closest(const Eigen::Vector3d& point, double reach = std::numeric_limits<double>::infinity()) const;

  /// The closest point within `reach` of a triangle whose normal turns from `normal` by no more than the angle of
  /// `least_cosine`. Where lips or lids touch, what is closest of all is the other one.
  /// normal  of length 1
  /// hint    a triangle that may be near, or -1: the search begins there, and is some times as fast
  SurfacePoint closestFacing(const Eigen::Vector3d& point, const Eigen::Vector3d& normal, double least_cosine,
                             double reach, int hint = -1) const;

  /// True if the point lies on the mesh's border: on an edge of one used triangle alone.
  bool onBorder(const SurfacePoint& point) const;

  /// Unit normals of the triangles, #T by 3; zero where there is no area.
  const Eigen::MatrixX3d& normals() const { return normals_; }

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
  Eigen::MatrixX3d normals_;
  Eigen::MatrixX3i triangles_;
  std::vector<unsigned char> border_edges_;  ///< #T: bit k for the edge opposite corner k
  std::vector<bool> border_vertices_;        ///< #V
};

}  // namespace facezip::geometry
