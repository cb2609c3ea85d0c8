#include "facezip/geometry/surface_matching.hpp"

#include <tbb/parallel_for.h>

#include <Eigen/Geometry>

#include "facezip/geometry/closest_surface.hpp"
#include "facezip/geometry/mesh_edges.hpp"

namespace facezip::geometry {

std::vector<PointTarget> matchSurface(const ScanPoints& scan, const MatchedSurface& surface,
                                      const Eigen::MatrixX3d& positions, const MatchOptions& options,
                                      std::vector<int>& hints) {
  const ClosestSurface mesh(positions, surface.triangles, surface.used);
  const Eigen::MatrixX3d normals = vertexNormals(positions, surface.triangles);
  const auto count = static_cast<std::size_t>(scan.size());
  std::vector<PointTarget> all(count);
  std::vector<char> found(count, 0);
  hints.resize(count, -1);
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
    const auto row = static_cast<Eigen::Index>(i);
    if (scan.areas[row] <= 0.0) return;
    const SurfacePoint match =
        mesh.closestFacing(scan.positions.row(row).transpose(), scan.normals.row(row).transpose(), options.least_cosine,
                           options.reach, hints[i]);
    hints[i] = match.triangle;
    if (!match.found() || mesh.onBorder(match)) return;
    PointTarget& target = all[i];
    target.vertices = surface.triangles.row(match.triangle);
    target.barycentric = match.barycentric.transpose();
    target.target = scan.positions.row(row);
    Eigen::RowVector3d along = scan.normals.row(row);
    for (int k = 0; k < 3; ++k) along += match.barycentric[k] * normals.row(target.vertices[k]);
    along.normalize();
    const double share = match.distance / options.kernel;
    const double robust = 1.0 / ((1.0 + share * share) * (1.0 + share * share));
    target.metric = (scan.areas[row] * robust) * along.transpose() * along;
    found[i] = 1;
  });
  std::vector<PointTarget> targets;
  targets.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    if (found[i] != 0) targets.push_back(all[i]);
  }
  return targets;
}

std::vector<MeshSample> sampleMesh(const Eigen::MatrixX3d& positions, const MatchedSurface& surface) {
  std::vector<MeshSample> samples;
  Eigen::VectorXd corner_areas = Eigen::VectorXd::Zero(positions.rows());
  for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
    if (!surface.used[static_cast<std::size_t>(t)]) continue;
    const Eigen::RowVector3i triangle = surface.triangles.row(t);
    const Eigen::RowVector3d a = positions.row(triangle[0]), b = positions.row(triangle[1]),
                             c = positions.row(triangle[2]);
    const double area = 0.5 * (b - a).cross(c - a).norm();
    if (!(area > 0.0)) continue;
    samples.push_back({triangle, Eigen::RowVector3d::Constant(1.0 / 3.0), 0.5 * area});
    for (int k = 0; k < 3; ++k) corner_areas[triangle[k]] += area / 6.0;
  }
  for (Eigen::Index v = 0; v < corner_areas.size(); ++v) {
    if (corner_areas[v] <= 0.0) continue;
    const int vertex = static_cast<int>(v);
    samples.push_back({{vertex, vertex, vertex}, {1.0, 0.0, 0.0}, corner_areas[v]});
  }
  return samples;
}

std::vector<PointTarget> matchSamples(const std::vector<MeshSample>& samples, const ClosestSurface& scan,
                                      const std::vector<float>& trust, const MatchedSurface& surface,
                                      const Eigen::MatrixX3d& positions, const MatchOptions& options,
                                      std::vector<int>& hints) {
  const Eigen::MatrixX3d normals = vertexNormals(positions, surface.triangles);
  std::vector<PointTarget> all(samples.size());
  hints.resize(samples.size(), -1);
  tbb::parallel_for(std::size_t{0}, samples.size(), [&](std::size_t i) {
    const MeshSample& sample = samples[i];
    PointTarget& target = all[i];
    target.metric.setZero();
    Eigen::RowVector3d point = Eigen::RowVector3d::Zero(), normal = Eigen::RowVector3d::Zero();
    for (int k = 0; k < 3; ++k) {
      point += sample.barycentric[k] * positions.row(sample.vertices[k]);
      normal += sample.barycentric[k] * normals.row(sample.vertices[k]);
    }
    normal.normalize();
    const SurfacePoint match =
        scan.closestFacing(point.transpose(), normal.transpose(), options.least_cosine, options.reach, hints[i]);
    hints[i] = match.triangle;
    if (!match.found() || scan.onBorder(match)) return;
    const Eigen::RowVector3d along = (normal + scan.normals().row(match.triangle)).normalized();
    const double trusted = trust.empty() ? 1.0 : double{trust[static_cast<std::size_t>(match.triangle)]};
    const double share = match.distance / options.kernel;
    const double robust = 1.0 / ((1.0 + share * share) * (1.0 + share * share));
    target = {sample.vertices, sample.barycentric, match.position.transpose(),
              (sample.area * trusted * robust) * along.transpose() * along};
  });
  std::erase_if(all, [](const PointTarget& target) { return target.metric.isZero(0.0); });
  return all;
}

}  // namespace facezip::geometry
