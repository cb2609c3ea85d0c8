#include "facezip/geometry/part_transfer.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>

#include "facezip/geometry/deformation_transfer.hpp"
#include "facezip/geometry/weight_solver.hpp"

namespace facezip::geometry {
namespace {

// Skin counts by its distance to the part, with this share of the head's diagonal as the scale: the lids around an eye,
// the mouth around the teeth.
constexpr double kAround = 0.03;
// Each shape is mostly the template's of its name: what the skin leaves open stays there.
constexpr double kOwnName = 1e-3;

/// Part of every vertex beyond the skin, counted from 0, by the triangles between such vertices.
std::vector<int> componentsOf(const PartProblem& problem, int& count) {
  const Eigen::Index total = problem.template_neutral.rows();
  std::vector<int> parent(static_cast<std::size_t>(total));
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](int v) {
    while (parent[static_cast<std::size_t>(v)] != v) {
      v = parent[static_cast<std::size_t>(v)] = parent[static_cast<std::size_t>(parent[static_cast<std::size_t>(v)])];
    }
    return v;
  };
  for (const auto& triangle : problem.triangles.rowwise()) {
    for (int corner = 0; corner < 3; ++corner) {
      const int a = triangle[corner], b = triangle[(corner + 1) % 3];
      if (a >= problem.skin && b >= problem.skin) parent[static_cast<std::size_t>(root(a))] = root(b);
    }
  }
  std::vector<int> label(static_cast<std::size_t>(total), -1), component;
  count = 0;
  for (auto v = static_cast<int>(problem.skin); v < total; ++v) {
    int& of_root = label[static_cast<std::size_t>(root(v))];
    if (of_root < 0) of_root = count++;
    component.push_back(of_root);
  }
  return component;
}

/// The similarity of the skin around a part's vertices.
Similarity placeOf(const PartProblem& problem, const std::vector<int>& vertices) {
  const double around = kAround * boundingDiagonal(problem.template_neutral.topRows(problem.skin));
  // Distances to every tenth or so of its vertices say enough of where a part is.
  const std::size_t stride = vertices.size() / 64 + 1;
  Eigen::VectorXd nearest = Eigen::VectorXd::Constant(problem.skin, std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < vertices.size(); i += stride) {
    const Eigen::RowVector3d point = problem.template_neutral.row(vertices[i]);
    for (Eigen::Index v = 0; v < problem.skin; ++v) {
      nearest[v] = std::min(nearest[v], (problem.template_neutral.row(v) - point).squaredNorm());
    }
  }
  // From the nearest skin on: a part far from all skin goes with what is least far.
  const Eigen::ArrayXd distance = nearest.array().sqrt() - std::sqrt(nearest.minCoeff());
  const Eigen::VectorXd weights = (-(distance / around).square()).exp().max(1e-12);
  return fitSimilarity(problem.template_neutral.topRows(problem.skin), problem.neutral, weights);
}

}  // namespace

Parts transferParts(const PartProblem& problem) {
  const auto shapes = static_cast<Eigen::Index>(problem.template_shapes.size());
  const Eigen::Index beyond = problem.template_neutral.rows() - problem.skin;
  assert(beyond >= 0 && problem.neutral.rows() == problem.skin);
  Parts parts;
  parts.neutral.resize(beyond, 3);
  const std::vector<int> component = componentsOf(problem, parts.count);
  // On the subject: each part where its skin is, its shapes turned and scaled alike.
  std::vector<Eigen::MatrixX3d> moved(problem.template_shapes.size(), Eigen::MatrixX3d::Zero(beyond, 3));
  for (int part = 0; part < parts.count; ++part) {
    std::vector<int> vertices;
    for (std::size_t i = 0; i < component.size(); ++i) {
      if (component[i] == part) vertices.push_back(static_cast<int>(problem.skin) + static_cast<int>(i));
    }
    const Similarity place = placeOf(problem, vertices);
    for (const int v : vertices) {
      const Eigen::Index row = v - problem.skin;
      parts.neutral.row(row) = place.apply(problem.template_neutral.row(v));
      for (std::size_t m = 0; m < moved.size(); ++m) {
        moved[m].row(row) = place.applyToVectors(problem.template_shapes[m].row(v) - problem.template_neutral.row(v));
      }
    }
  }
  const WeightSolver explain(problem.neutral, problem.transferred);
  parts.coefficients.resize(shapes, shapes);
  for (Eigen::Index m = 0; m < shapes; ++m) {
    const Eigen::VectorXd own = Eigen::VectorXd::Unit(shapes, m);
    const Eigen::VectorXd projected = explain.project(problem.neutral + problem.shapes[static_cast<std::size_t>(m)]);
    parts.coefficients.row(m) = explain.solve(projected, own, kOwnName).transpose();
    Eigen::MatrixX3d shape = Eigen::MatrixX3d::Zero(beyond, 3);
    for (Eigen::Index j = 0; j < shapes; ++j) {
      if (parts.coefficients(m, j) != 0.0) shape += parts.coefficients(m, j) * moved[static_cast<std::size_t>(j)];
    }
    parts.shapes.push_back(std::move(shape));
  }
  return parts;
}

}  // namespace facezip::geometry
