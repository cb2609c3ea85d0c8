#include "facezip/geometry/skin_registration.hpp"

#include <Eigen/Geometry>
#include <utility>

#include "facezip/geometry/mesh_edges.hpp"

namespace facezip::geometry {
namespace {

constexpr double kLength = 2.0;          // millimetres: flow is smooth by itself
constexpr double kMembraneShare = 0.05;  // of the length
constexpr double kAnchor = 0.02;         // of the area, towards the fitted shapes: without it rounds wander off
constexpr double kKernel = 0.8;          // of the closest points
constexpr double kLeastCosine = 0.5;
constexpr double kReach = 20.0;
constexpr double kSampleWeight = 0.2;
constexpr double kSkinWeight = 0.3;       // beside closest points: these know their place to the scan's noise
constexpr double kLandmarkWeight = 0.02;  // square millimetres
constexpr double kLandmarkKernel = 3.0;

Eigen::Matrix3d acrossPlane(const Eigen::RowVector3d& normal) {
  return Eigen::Matrix3d::Identity() - normal.transpose() * normal;
}

}  // namespace

SkinRegistration::SkinRegistration(BentSurface surface)
    : surface_(std::move(surface)),
      deformation_(surface_.reference, surface_.matched.triangles,
                   stiffnessAt(kLength, kMembraneShare, kAnchor, surface_), surface_.seenVertices()) {}

Eigen::MatrixX3d SkinRegistration::draw(const Eigen::MatrixX3d& posed, const Eigen::MatrixX3d& placed,
                                        const std::vector<SkinPoint>& points, const ScanSurface& scan,
                                        const std::vector<Landmark>& landmarks) const {
  const MatchedSurface& matched = surface_.matched;
  const MatchOptions match{kKernel, kLeastCosine, kReach};
  std::vector<int> point_hints, sample_hints;
  std::vector<PointTarget> targets = matchSurface(scan.points(), matched, placed, match, point_hints);
  for (PointTarget& target : matchSamples(sampleMesh(placed, matched), scan.surface(), scan.judged().trust, matched,
                                          placed, match, sample_hints)) {
    target.metric *= kSampleWeight;
    targets.push_back(target);
  }
  const Eigen::MatrixX3d normals = vertexNormals(placed, matched.triangles);
  for (const SkinPoint& point : points) {
    const Eigen::RowVector3i corners = matched.triangles.row(point.triangle);
    const Eigen::RowVector3d normal = (point.barycentric * normals(corners, Eigen::all)).normalized();
    const double area = triangleArea(surface_.reference, matched.triangles, point.triangle);
    targets.push_back(
        {corners, point.barycentric, point.target, kSkinWeight * point.trust * area * acrossPlane(normal)});
  }
  for (const Landmark& mark : landmarks) {
    const double share = (mark.position - placed.row(mark.vertex)).norm() / kLandmarkKernel;
    const double weight = kLandmarkWeight / ((1.0 + share * share) * (1.0 + share * share));
    targets.push_back({{mark.vertex, mark.vertex, mark.vertex},
                       {1.0, 0.0, 0.0},
                       mark.position,
                       weight * Eigen::Matrix3d::Identity()});
  }
  return deformation_.solve(targets, posed, placed, 40);
}

}  // namespace facezip::geometry
