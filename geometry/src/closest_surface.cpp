// closest_surface.cpp - closest points through CGAL's AABB tree, with a traversal of our own: CGAL's takes what is
// closest, whichever way it faces.
#include "facezip/geometry/closest_surface.hpp"

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/Simple_cartesian.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>

#include "facezip/geometry/mesh_edges.hpp"

namespace facezip::geometry {
namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;
using RowMajorInt = Eigen::Matrix<int, Eigen::Dynamic, 3, Eigen::RowMajor>;
using Kernel = CGAL::Simple_cartesian<double>;
using Point = Kernel::Point_3;

Point toCgal(const Eigen::Vector3d& p) { return {p.x(), p.y(), p.z()}; }

/// A triangle by its number; where its corners are is the tree's to know, once for all of them.
struct Primitive {
  using Id = int;
  using Point = Kernel::Point_3;
  using Datum = Kernel::Triangle_3;
  struct Shared {
    const RowMajor* positions;
    const RowMajorInt* triangles;
  };
  using Shared_data = Shared;

  Primitive() = default;
  Primitive(std::vector<int>::const_iterator id, const Shared&) : id_(*id) {}
  static Shared construct_shared_data(const Shared& shared) { return shared; }

  Id id() const { return id_; }
  static Point corner(int triangle, int k, const Shared& shared) {
    return toCgal(shared.positions->row((*shared.triangles)(triangle, k)).transpose());
  }
  Datum datum(const Shared& shared) const {
    return {corner(id_, 0, shared), corner(id_, 1, shared), corner(id_, 2, shared)};
  }
  Point reference_point(const Shared& shared) const { return corner(id_, 0, shared); }

 private:
  int id_ = -1;
};

using Traits = CGAL::AABB_traits<Kernel, Primitive>;
using AabbTree = CGAL::AABB_tree<Traits>;
using Node = CGAL::AABB_node<Traits>;

/// Barycentric coordinates of the point of the triangle a b c that is closest to p (Ericson 2004, section 5.1.5).
Eigen::Vector3d closestOfTriangle(const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                  const Eigen::Vector3d& c) {
  const Eigen::Vector3d ab = b - a, ac = c - a, ap = p - a;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0.0 && d2 <= 0.0) return {1, 0, 0};
  const Eigen::Vector3d bp = p - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0.0 && d4 <= d3) return {0, 1, 0};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return {1 - d1 / (d1 - d3), d1 / (d1 - d3), 0};
  const Eigen::Vector3d cp = p - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0.0 && d5 <= d6) return {0, 0, 1};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return {1 - d2 / (d2 - d6), 0, d2 / (d2 - d6)};
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 >= d3 && d5 >= d6) {
    const double w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return {0, 1 - w, w};
  }
  const double sum = va + vb + vc;
  return {va / sum, vb / sum, vc / sum};
}

/// Keeps the closest point of the triangles that face the right way; boxes beyond it are not entered.
class FacingProjection {
 public:
  FacingProjection(const RowMajor& positions, const RowMajorInt& triangles, const RowMajor& normals,
                   const Eigen::Vector3d& normal, double least_cosine, double reach)
      : positions_(positions),
        triangles_(triangles),
        normals_(normals),
        normal_(normal),
        least_cosine_(least_cosine),
        squared_(reach * reach) {}

  bool go_further() const { return true; }

  void intersection(const Point& query, const Primitive& primitive) {
    consider(Eigen::Vector3d(query.x(), query.y(), query.z()), primitive.id());
  }

  void consider(const Eigen::Vector3d& p, int t) {
    if (normals_.row(t).dot(normal_) < least_cosine_) return;
    const Eigen::Vector3d a = positions_.row(triangles_(t, 0)), b = positions_.row(triangles_(t, 1)),
                          c = positions_.row(triangles_(t, 2));
    const Eigen::Vector3d barycentric = closestOfTriangle(p, a, b, c);
    const Eigen::Vector3d position = barycentric[0] * a + barycentric[1] * b + barycentric[2] * c;
    const double squared = (p - position).squaredNorm();
    // Of equals, on a shared edge, the lowest number: the tree's order is nobody's business.
    if (squared > squared_ || (squared == squared_ && best_.found() && best_.triangle < t)) return;
    squared_ = squared;
    best_ = {t, barycentric, position, std::sqrt(squared)};
  }

  bool do_intersect(const Point& query, const Node& node) const {
    const CGAL::Bbox_3 box = node.bbox();
    double squared = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
      const double q = query[axis];
      const double beyond = std::max({box.min(axis) - q, q - box.max(axis), 0.0});
      squared += beyond * beyond;
    }
    return squared <= squared_;
  }

  const SurfacePoint& best() const { return best_; }

 private:
  const RowMajor& positions_;
  const RowMajorInt& triangles_;
  const RowMajor& normals_;
  Eigen::Vector3d normal_;
  double least_cosine_;
  double squared_;
  SurfacePoint best_;
};

}  // namespace

// What a query reads of a triangle lies together, so by rows.
struct ClosestSurface::Tree {
  RowMajor positions;
  RowMajor normals;
  RowMajorInt triangles;
  AabbTree tree;
};

ClosestSurface::ClosestSurface(const Eigen::MatrixX3d& positions, const Eigen::MatrixX3i& triangles,
                               std::vector<bool> used)
    : tree_(std::make_unique<Tree>()), normals_(triangleNormals(positions, triangles)), triangles_(triangles) {
  assert(used.empty() || static_cast<Eigen::Index>(used.size()) == triangles.rows());
  used.resize(static_cast<std::size_t>(triangles.rows()), true);
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    if (normals_.row(t).isZero(0.0)) used[static_cast<std::size_t>(t)] = false;
  }
  border_edges_ = borderEdges(triangles, used);
  border_vertices_.assign(static_cast<std::size_t>(positions.rows()), false);
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) {
      if ((border_edges_[static_cast<std::size_t>(t)] & (1 << k)) == 0) continue;
      border_vertices_[static_cast<std::size_t>(triangles(t, (k + 1) % 3))] = true;
      border_vertices_[static_cast<std::size_t>(triangles(t, (k + 2) % 3))] = true;
    }
  }
  tree_->positions = positions;
  tree_->normals = normals_;
  tree_->triangles = triangles;
  std::vector<int> ids;
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    if (used[static_cast<std::size_t>(t)]) ids.push_back(static_cast<int>(t));
  }
  tree_->tree.insert(ids.begin(), ids.end(), Primitive::Shared{&tree_->positions, &tree_->triangles});
  if (!ids.empty()) tree_->tree.build();
}

ClosestSurface::~ClosestSurface() = default;
ClosestSurface::ClosestSurface(ClosestSurface&&) noexcept = default;
ClosestSurface& ClosestSurface::operator=(ClosestSurface&&) noexcept = default;

SurfacePoint ClosestSurface::closest(const Eigen::Vector3d& point, double reach) const {
  return closestFacing(point, Eigen::Vector3d::UnitX(), -2.0, reach);
}

SurfacePoint ClosestSurface::closestFacing(const Eigen::Vector3d& point, const Eigen::Vector3d& normal,
                                           double least_cosine, double reach, int hint) const {
  FacingProjection projection(tree_->positions, tree_->triangles, tree_->normals, normal, least_cosine, reach);
  if (hint >= 0) projection.consider(point, hint);
  if (!tree_->tree.empty()) tree_->tree.traversal(toCgal(point), projection);
  return projection.best();
}

bool ClosestSurface::onBorder(const SurfacePoint& point) const {
  constexpr double kOnEdge = 1e-9;
  for (int k = 0; k < 3; ++k) {
    if (point.barycentric[k] > 1.0 - kOnEdge) {
      return border_vertices_[static_cast<std::size_t>(triangles_(point.triangle, k))];
    }
    if (point.barycentric[k] < kOnEdge && (border_edges_[static_cast<std::size_t>(point.triangle)] & (1 << k)) != 0) {
      return true;
    }
  }
  return false;
}

}  // namespace facezip::geometry
