#include "facezip/geometry/nonrigid_registration.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <boost/pending/disjoint_sets.hpp>
#include <cassert>
#include <cmath>

#include "facezip/geometry/mesh_edges.hpp"

namespace facezip::geometry {
namespace {

constexpr double kLeastCosine = 0.5;
constexpr double kReach = 20.0;
// The mesh asks, too, but less loudly: its vertices stand off the skin wherever that is bent (surface_matching.hpp).
constexpr double kSampleWeight = 0.3;
constexpr double kMembraneShare = 0.002;  // of the bending length
constexpr double kAnchor = 1e-4;
constexpr double kUnseenMembrane = 100.0;
constexpr double kSmallHole = 0.05;  // of the area that is seen
// A kernel below a few times the residual's median takes the surface's own noise for outliers.
constexpr double kKernelOverMedian = 4.5;
// Along the surface closest points say nothing: a slight hold against sliding between rounds.
constexpr double kSlideHold = 0.02;
constexpr double kConverged = 0.01;
constexpr double kLandmarkKernel = 3.0;
constexpr double kLandmarkWeight = 10.0;      // times the square of the length: as the area that it bends
constexpr double kLastLandmarkWeight = 0.33;  // clicks are noise to the last step

void addLandmarks(const std::vector<Landmark>& landmarks, const Eigen::MatrixX3d& x, const Eigen::MatrixX3d& normals,
                  double weight, std::vector<PointTarget>& targets) {
  for (const Landmark& mark : landmarks) {
    const double share = (mark.position - x.row(mark.vertex)).norm() / kLandmarkKernel;
    const double robust = weight / ((1.0 + share * share) * (1.0 + share * share));
    const Eigen::RowVector3d n = normals.row(mark.vertex);
    targets.push_back({{mark.vertex, mark.vertex, mark.vertex},
                       {1.0, 0.0, 0.0},
                       mark.position,
                       robust * (Eigen::Matrix3d::Identity() - n.transpose() * n)});
  }
}

/// Median distance of the targets along their planes.
double medianResidual(const std::vector<PointTarget>& targets, std::size_t count, const Eigen::MatrixX3d& x) {
  std::vector<double> residuals;
  residuals.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const PointTarget& target = targets[i];
    Eigen::RowVector3d missing = -target.target;
    for (int k = 0; k < 3; ++k) missing += target.barycentric[k] * x.row(target.vertices[k]);
    const double weight = target.metric.trace();
    if (weight > 0.0) residuals.push_back(std::sqrt(std::max(0.0, (missing * target.metric).dot(missing) / weight)));
  }
  if (residuals.empty()) return 0.0;
  const auto middle = residuals.begin() + static_cast<std::ptrdiff_t>(residuals.size() / 2);
  std::nth_element(residuals.begin(), middle, residuals.end());
  return *middle;
}

/// Holes of a scan, nostrils and lips are unseen, too, but move with the skin around them: small unseen parts that
/// touch what is seen count as seen. Were they stiff, they would hold the skin beside them.
void fillHoles(const Eigen::MatrixX3d& positions, const Eigen::MatrixX3i& triangles, std::vector<bool>& seen) {
  const auto vertices = static_cast<std::size_t>(positions.rows());
  std::vector<int> rank(vertices), parent(vertices);
  boost::disjoint_sets<int*, int*> parts(rank.data(), parent.data());
  for (std::size_t v = 0; v < vertices; ++v) parts.make_set(static_cast<int>(v));
  std::vector<bool> beside_seen(vertices, false), touches(vertices, false);
  std::vector<double> areas(vertices, 0.0);
  double seen_area = 0.0;
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    if (seen[static_cast<std::size_t>(t)]) {
      seen_area += triangleArea(positions, triangles, t);
      for (int k = 0; k < 3; ++k) beside_seen[static_cast<std::size_t>(triangles(t, k))] = true;
    } else {
      parts.union_set(triangles(t, 0), triangles(t, 1));
      parts.union_set(triangles(t, 0), triangles(t, 2));
    }
  }
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    if (seen[static_cast<std::size_t>(t)]) continue;
    const auto part = static_cast<std::size_t>(parts.find_set(triangles(t, 0)));
    areas[part] += triangleArea(positions, triangles, t);
    for (int k = 0; k < 3; ++k) touches[part] = touches[part] || beside_seen[static_cast<std::size_t>(triangles(t, k))];
  }
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    if (seen[static_cast<std::size_t>(t)]) continue;
    const auto part = static_cast<std::size_t>(parts.find_set(triangles(t, 0)));
    if (touches[part] && areas[part] < kSmallHole * seen_area) seen[static_cast<std::size_t>(t)] = true;
  }
}

}  // namespace

Eigen::VectorXd BentSurface::seenVertices() const {
  Eigen::VectorXd vertices = Eigen::VectorXd::Zero(reference.rows());
  for (std::size_t t = 0; t < seen.size(); ++t) {
    if (!seen[t]) continue;
    for (int k = 0; k < 3; ++k) vertices[matched.triangles(static_cast<Eigen::Index>(t), k)] = 1.0;
  }
  return vertices;
}

std::vector<bool> seenTriangles(const Eigen::MatrixX3d& positions, const Eigen::MatrixX3i& triangles,
                                const ScanSurface& scan, double reach) {
  const Eigen::MatrixX3d normals = triangleNormals(positions, triangles);
  std::vector<char> found(static_cast<std::size_t>(triangles.rows()), 0);
  tbb::parallel_for(std::size_t{0}, found.size(), [&](std::size_t t) {
    const auto row = static_cast<Eigen::Index>(t);
    if (normals.row(row).isZero(0.0)) return;
    const Eigen::RowVector3d centre = positions(triangles.row(row), Eigen::all).colwise().mean();
    const SurfacePoint match =
        scan.surface().closestFacing(centre.transpose(), normals.row(row).transpose(), kLeastCosine, reach);
    found[t] = match.found() && !scan.surface().onBorder(match) ? 1 : 0;
  });
  std::vector<bool> seen(found.begin(), found.end());
  fillHoles(positions, triangles, seen);
  return seen;
}

Stiffness stiffnessAt(double length, double membrane_share, double anchor, const BentSurface& surface) {
  Stiffness stiffness;
  stiffness.bending = length;
  stiffness.membrane = membrane_share * length;
  stiffness.anchor = anchor;
  stiffness.membrane_factor.resize(static_cast<Eigen::Index>(surface.seen.size()));
  for (std::size_t t = 0; t < surface.seen.size(); ++t) {
    stiffness.membrane_factor[static_cast<Eigen::Index>(t)] = surface.seen[t] ? 1.0 : kUnseenMembrane;
  }
  return stiffness;
}

Eigen::MatrixX3d registerNonRigid(const BentSurface& surface, const Eigen::MatrixX3d& start, const ScanSurface& scan,
                                  const std::vector<Landmark>& landmarks, const NonRigidOptions& options,
                                  const std::function<void()>& round_begins) {
  assert(options.steps >= 1 && static_cast<Eigen::Index>(surface.seen.size()) == surface.matched.triangles.rows());
  const Eigen::MatrixX3i& triangles = surface.matched.triangles;
  const Eigen::VectorXd density = surface.seenVertices();
  const Eigen::VectorXd areas = vertexAreas(surface.reference, triangles);
  Eigen::MatrixX3d x = start;
  double kernel = options.first_kernel, median = 0.0;
  std::vector<int> point_hints, sample_hints;
  for (int step = 0; step < options.steps; ++step) {
    const bool last = step + 1 == options.steps;
    const double share = options.steps > 1 ? static_cast<double>(step) / (options.steps - 1) : 1.0;
    const double length = options.first_length * std::pow(options.last_length / options.first_length, share);
    const SurfaceDeformation deformation(surface.reference, triangles,
                                         stiffnessAt(length, kMembraneShare, kAnchor, surface), density);
    const Eigen::MatrixX3d rest = x;
    for (int round = 0; round < options.rounds; ++round) {
      if (round_begins) round_begins();
      const MatchOptions match{kernel, kLeastCosine, kReach};
      std::vector<PointTarget> targets = matchSurface(scan.points(), surface.matched, x, match, point_hints);
      for (PointTarget& target : matchSamples(sampleMesh(x, surface.matched), scan.surface(), scan.judged().trust,
                                              surface.matched, x, match, sample_hints)) {
        target.metric *= kSampleWeight;
        targets.push_back(target);
      }
      const std::size_t matches = targets.size();
      addLandmarks(landmarks, x, vertexNormals(x, triangles),
                   options.landmark_share * (last ? kLastLandmarkWeight : kLandmarkWeight * length * length), targets);
      for (Eigen::Index v = 0; v < x.rows(); ++v) {
        if (density[v] == 0.0) continue;
        const int vertex = static_cast<int>(v);
        targets.push_back(
            {{vertex, vertex, vertex}, {1.0, 0.0, 0.0}, x.row(v), kSlideHold * areas[v] * Eigen::Matrix3d::Identity()});
      }
      const Eigen::MatrixX3d before = x;
      x = deformation.solve(targets, rest, x, 20);
      median = medianResidual(targets, matches, x);
      kernel = std::max(options.last_kernel, kKernelOverMedian * median);
      if ((x - before).rowwise().norm().mean() < kConverged) break;
    }
    if (median <= scan.judged().roughness) break;
  }
  return x;
}

ScanResidual residualOf(const BentSurface& surface, const Eigen::MatrixX3d& positions, const ScanSurface& scan,
                        double reach) {
  const ClosestSurface mesh(positions, surface.matched.triangles, surface.matched.used);
  const ScanPoints& points = scan.points();
  std::vector<double> distances(static_cast<std::size_t>(points.size()), -1.0);
  tbb::parallel_for(std::size_t{0}, distances.size(), [&](std::size_t i) {
    const auto row = static_cast<Eigen::Index>(i);
    const SurfacePoint match = mesh.closestFacing(points.positions.row(row).transpose(),
                                                  points.normals.row(row).transpose(), kLeastCosine, reach);
    if (match.found() && !mesh.onBorder(match)) distances[i] = match.distance;
  });
  ScanResidual residual;
  double area = 0.0;
  for (std::size_t i = 0; i < distances.size(); ++i) {
    if (distances[i] < 0.0) continue;
    area += points.areas[static_cast<Eigen::Index>(i)];
    residual.mean += points.areas[static_cast<Eigen::Index>(i)] * distances[i];
  }
  std::erase_if(distances, [](double d) { return d < 0.0; });
  if (distances.empty()) return residual;
  residual.mean /= area;
  residual.matched = area / points.areas.sum();
  const auto rank = distances.begin() + static_cast<std::ptrdiff_t>(0.99 * static_cast<double>(distances.size() - 1));
  std::nth_element(distances.begin(), rank, distances.end());
  residual.percentile_99 = *rank;
  return residual;
}

}  // namespace facezip::geometry
