#include "rig/texture_solve.hpp"

#include <tbb/parallel_for.h>

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <cassert>

namespace facezip {

template <>
const std::vector<NamedValue<TextureSolve>>& namesOf() {
  static const std::vector<NamedValue<TextureSolve>> names = {
      {TextureSolve::kLocal, "local", "local"},
      {TextureSolve::kDamped, "damped", "damped"},
      {TextureSolve::kPseudoInverse, "pseudo-inverse", "pseudo-inverse"},
      {TextureSolve::kStrain, "strain", "strain"},
  };
  return names;
}

TextureSolve textureSolveOf(const RigOptions& options) {
  const Method method = options.compress.method;
  const bool stretches = method == Method::kCompressStretch;
  if (options.texture_solve) {
    if (stretches == (*options.texture_solve == TextureSolve::kStrain)) return *options.texture_solve;
    throw InputError({"--texture-solve", "",
                      stretches ? "strain, as --method compress-stretch blends its two maps by the strain of the skin"
                                : "local, damped or pseudo-inverse: strain goes with --method compress-stretch",
                      nameOf(*options.texture_solve), "leave it out: what suits the method is taken"});
  }
  if (stretches) return TextureSolve::kStrain;
  const bool papers = method == Method::kPaper || method == Method::kNoPermutation;
  return papers ? TextureSolve::kPseudoInverse : TextureSolve::kLocal;
}

}  // namespace facezip

namespace facezip::rig {
namespace {

constexpr double kRankTolerance = 1e-6;
constexpr double kDampings[] = {0.003, 0.01, 0.03, 0.1, 0.3, 1.0};
constexpr double kStrainShares[] = {0.0, 0.01, 0.03, 0.1, 0.3};

Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> decompose(const Eigen::MatrixXd& weights) {
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> decomposition;
  decomposition.setThreshold(kRankTolerance);
  return decomposition.compute(weights);
}

/// K without lambda, in its two terms.
struct Covariance {
  Eigen::MatrixXd by_shapes;  ///< B A B^T
  Eigen::MatrixXd by_strain;  ///< E E^T
};

Covariance covarianceOf(const Eigen::MatrixXd& weights, const PointFeatures& point) {
  return {weights * point.influence.asDiagonal() * weights.transpose(),
          point.of_examples * point.of_examples.transpose()};
}

}  // namespace

int rankOf(const Eigen::MatrixXd& weights) { return static_cast<int>(decompose(weights).rank()); }

Eigen::MatrixXd globalSolution(const TextureSolver& solver) {
  assert(solver.method == TextureSolve::kDamped || solver.method == TextureSolve::kPseudoInverse);
  const Eigen::MatrixXd& b = solver.weights;
  if (solver.method == TextureSolve::kPseudoInverse) return decompose(b).pseudoInverse();
  Eigen::MatrixXd system = b * b.transpose();
  system.diagonal().array() += solver.damping;
  return system.llt().solve(b).transpose();
}

Eigen::MatrixXd localSolution(const TextureSolver& solver, const PointFeatures& point) {
  const Covariance covariance = covarianceOf(solver.weights, point);
  Eigen::MatrixXd system = covariance.by_shapes + solver.strain_share * covariance.by_strain;
  system.diagonal().array() += solver.damping;
  const Eigen::MatrixXd shapes_with_examples = point.influence.asDiagonal() * solver.weights.transpose() +
                                               solver.strain_share * point.of_shapes * point.of_examples.transpose();
  return system.llt().solve(shapes_with_examples.transpose()).transpose();
}

LeftOut leaveOneOut(const TextureSolver& solver, std::span<const SolvedCell> cells, std::optional<double> damping) {
  std::vector<LeftOut> candidates;
  for (const double share : kStrainShares) {
    for (const double lambda : kDampings) {
      if (!damping) candidates.push_back({lambda, share, 0.0, 0.0});
    }
    if (damping) candidates.push_back({*damping, share, 0.0, 0.0});
  }
  // Summed cell by cell in order, whatever the number of threads.
  std::vector<std::vector<double>> errors(cells.size(), std::vector<double>(candidates.size()));
  tbb::parallel_for(std::size_t{0}, cells.size(), [&](std::size_t c) {
    const Covariance covariance = covarianceOf(solver.weights, cells[c].point);
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      Eigen::MatrixXd system = covariance.by_shapes + candidates[i].strain_share * covariance.by_strain;
      system.diagonal().array() += candidates[i].damping;
      const Eigen::MatrixXd inverse = system.llt().solve(Eigen::MatrixXd::Identity(system.rows(), system.cols()));
      const Eigen::VectorXd squares = (inverse * cells[c].gram).cwiseProduct(inverse).rowwise().sum();
      errors[c][i] = (squares.array() / inverse.diagonal().array().square()).sum();
    }
  });
  for (std::size_t c = 0; c < cells.size(); ++c) {
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      candidates[i].error += errors[c][i];
      candidates[i].nothing += cells[c].gram.trace();
    }
  }
  return *std::min_element(candidates.begin(), candidates.end(),
                           [](const LeftOut& a, const LeftOut& b) { return a.error < b.error; });
}

}  // namespace facezip::rig
