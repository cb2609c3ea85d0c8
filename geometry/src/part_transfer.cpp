#include "facezip/geometry/part_transfer.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "facezip/geometry/deformation_transfer.hpp"
#include "facezip/geometry/weight_solver.hpp"

namespace facezip::geometry {
namespace {

// Skin counts by its distance to the part, with this share of the head's diagonal as the scale: the lids around an eye,
// the mouth around the teeth.
constexpr double kAround = 0.03;
// Each shape is mostly the template's of its name: what the skin leaves open stays there.
constexpr double kOwnName = 1e-3;
// Vertices of the skin that a vertex on it follows: those around it on either side of an edge of a lid.
constexpr int kNeighbours = 6;

/// The similarity of the skin around a part's vertices.
Similarity placeOf(const PartProblem& problem, const std::vector<Eigen::Index>& vertices) {
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

/// What a vertex on the skin takes of its neighbours there.
struct SkinNeighbours {
  std::array<Eigen::Index, kNeighbours> vertices = {};
  std::array<double, kNeighbours> weights = {};  ///< 0 far from the skin

  template <typename RowOf>
  Eigen::RowVector3d mean(const RowOf& row_of) const {
    Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
    for (std::size_t k = 0; k < vertices.size(); ++k) {
      if (weights[k] > 0.0) sum += weights[k] * row_of(vertices[k]);
    }
    return sum;
  }
};

SkinNeighbours neighboursOf(const PartProblem& problem, Eigen::Index vertex) {
  const double around = kAround * boundingDiagonal(problem.template_neutral.topRows(problem.skin));
  const Eigen::RowVector3d point = problem.template_neutral.row(vertex);
  std::vector<std::pair<double, Eigen::Index>> near;
  for (Eigen::Index v = 0; v < problem.skin; ++v) {
    near.emplace_back((problem.template_neutral.row(v) - point).squaredNorm(), v);
  }
  const auto count = std::min<std::size_t>(kNeighbours, near.size());
  std::partial_sort(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(count), near.end());
  SkinNeighbours found;
  double sum = 0.0;
  for (std::size_t k = 0; k < count; ++k) {
    found.vertices[k] = near[k].second;
    found.weights[k] = 1.0 / (near[k].first + 1e-6 * around * around);  // on a vertex of the skin, that one alone
    sum += found.weights[k];
  }
  const double fade = std::exp(-near.front().first / (around * around));
  for (double& weight : found.weights) weight *= fade / sum;
  return found;
}

/// The groups of a problem, and what is known of each.
struct Groups {
  std::vector<std::vector<Eigen::Index>> vertices;  ///< of each, in the whole template
  std::vector<bool> on_skin;
};

Groups groupsOf(const PartProblem& problem) {
  const std::vector<int> group = problem.groups.empty()
                                     ? connectedParts(problem.skin, problem.template_neutral.rows(), problem.triangles)
                                     : problem.groups;
  Groups groups;
  for (std::size_t i = 0; i < group.size(); ++i) {
    const auto g = static_cast<std::size_t>(group[i]);
    if (g >= groups.vertices.size()) groups.vertices.resize(g + 1);
    groups.vertices[g].push_back(problem.skin + static_cast<Eigen::Index>(i));
  }
  groups.on_skin = problem.on_skin;
  groups.on_skin.resize(groups.vertices.size(), false);
  return groups;
}

/// Coefficients in [0, 1] of the template's shapes that best explain each of the subject's.
Eigen::MatrixXd explainShapes(const PartProblem& problem) {
  const auto shapes = static_cast<Eigen::Index>(problem.template_shapes.size());
  const WeightSolver explain(problem.neutral, problem.transferred);
  Eigen::MatrixXd coefficients(shapes, shapes);
  for (Eigen::Index m = 0; m < shapes; ++m) {
    const Eigen::VectorXd own = Eigen::VectorXd::Unit(shapes, m);
    const Eigen::VectorXd projected = explain.project(problem.neutral + problem.shapes[static_cast<std::size_t>(m)]);
    coefficients.row(m) = explain.solve(projected, own, kOwnName).transpose();
  }
  return coefficients;
}

/// A vertex as all of its shapes move it.
class VertexMotion {
 public:
  VertexMotion(const PartProblem& problem, const Similarity& place, const Eigen::MatrixXd& coefficients)
      : problem_(problem), place_(place), coefficients_(coefficients) {}

  /// M by 3: how the template's shapes, combined for each of the subject's, move vertex v, on the subject.
  Eigen::MatrixX3d operator()(Eigen::Index v) const {
    Eigen::MatrixX3d moved(coefficients_.cols(), 3);
    for (Eigen::Index m = 0; m < moved.rows(); ++m) {
      moved.row(m) = problem_.template_shapes[static_cast<std::size_t>(m)].row(v) - problem_.template_neutral.row(v);
    }
    return coefficients_ * place_.applyToVectors(moved);
  }

 private:
  const PartProblem& problem_;
  const Similarity& place_;
  const Eigen::MatrixXd& coefficients_;
};

void placeGroup(const PartProblem& problem, const std::vector<Eigen::Index>& vertices, bool on_skin, Parts& parts) {
  const Similarity place = placeOf(problem, vertices);
  const VertexMotion motion(problem, place, parts.coefficients);
  // What the skin does beyond the similarity and the template's shapes.
  const auto beside = [&](Eigen::Index v) -> Eigen::RowVector3d {
    return problem.neutral.row(v) - place.apply(problem.template_neutral.row(v));
  };
  tbb::parallel_for(std::size_t{0}, vertices.size(), [&](std::size_t i) {
    const Eigen::Index v = vertices[i], row = v - problem.skin;
    parts.neutral.row(row) = place.apply(problem.template_neutral.row(v));
    Eigen::MatrixX3d moved = motion(v);
    if (on_skin) {
      const SkinNeighbours neighbours = neighboursOf(problem, v);
      parts.neutral.row(row) += neighbours.mean(beside);
      for (std::size_t k = 0; k < neighbours.vertices.size(); ++k) {
        if (neighbours.weights[k] == 0.0) continue;
        const Eigen::Index n = neighbours.vertices[k];
        const Eigen::MatrixX3d explained = motion(n);
        for (std::size_t m = 0; m < problem.shapes.size(); ++m) {
          const auto shape = static_cast<Eigen::Index>(m);
          moved.row(shape) += neighbours.weights[k] * (problem.shapes[m].row(n) - explained.row(shape));
        }
      }
    }
    for (std::size_t m = 0; m < parts.shapes.size(); ++m) {
      parts.shapes[m].row(row) = moved.row(static_cast<Eigen::Index>(m));
    }
  });
}

}  // namespace

std::vector<int> connectedParts(Eigen::Index skin, Eigen::Index vertices, const Eigen::MatrixX3i& triangles) {
  std::vector<int> parent(static_cast<std::size_t>(vertices));
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](int v) {
    while (parent[static_cast<std::size_t>(v)] != v) {
      v = parent[static_cast<std::size_t>(v)] = parent[static_cast<std::size_t>(parent[static_cast<std::size_t>(v)])];
    }
    return v;
  };
  for (const auto& triangle : triangles.rowwise()) {
    for (int corner = 0; corner < 3; ++corner) {
      const int a = triangle[corner], b = triangle[(corner + 1) % 3];
      if (a >= skin && b >= skin) parent[static_cast<std::size_t>(root(a))] = root(b);
    }
  }
  std::vector<int> label(parent.size(), -1), component;
  int count = 0;
  for (auto v = static_cast<int>(skin); v < vertices; ++v) {
    int& of_root = label[static_cast<std::size_t>(root(v))];
    if (of_root < 0) of_root = count++;
    component.push_back(of_root);
  }
  return component;
}

Eigen::VectorXd distancesToSkin(Eigen::Index skin, const Eigen::MatrixX3d& template_neutral) {
  Eigen::VectorXd distances(template_neutral.rows() - skin);
  tbb::parallel_for(Eigen::Index{0}, distances.size(), [&](Eigen::Index i) {
    distances[i] =
        (template_neutral.topRows(skin).rowwise() - template_neutral.row(skin + i)).rowwise().norm().minCoeff();
  });
  return distances;
}

Parts transferParts(const PartProblem& problem) {
  const Eigen::Index beyond = problem.template_neutral.rows() - problem.skin;
  assert(beyond >= 0 && problem.neutral.rows() == problem.skin);
  const Groups groups = groupsOf(problem);
  Parts parts;
  parts.count = static_cast<int>(groups.vertices.size());
  parts.coefficients = explainShapes(problem);
  parts.neutral.resize(beyond, 3);
  parts.shapes.assign(problem.template_shapes.size(), Eigen::MatrixX3d::Zero(beyond, 3));
  for (std::size_t g = 0; g < groups.vertices.size(); ++g) {
    placeGroup(problem, groups.vertices[g], groups.on_skin[g], parts);
  }
  return parts;
}

}  // namespace facezip::geometry
