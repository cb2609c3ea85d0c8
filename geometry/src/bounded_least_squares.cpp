#include "facezip/geometry/bounded_least_squares.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <vector>

#include "facezip/error.hpp"

namespace facezip::geometry {
namespace {

// Beside the diagonal's largest entry: dependent shapes leave directions that nothing decides.
constexpr double kRidge = 1e-10;
constexpr double kGradientTolerance = 1e-10;

/// The unconstrained optimum over the free unknowns, the others as they are in x.
Eigen::VectorXd solveFree(const Eigen::MatrixXd& hessian, const Eigen::VectorXd& linear, const Eigen::VectorXd& x,
                          const std::vector<int>& free) {
  const auto count = static_cast<Eigen::Index>(free.size());
  Eigen::MatrixXd h(count, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    for (Eigen::Index j = 0; j < count; ++j) h(i, j) = hessian(free[i], free[j]);
  }
  // The step from x, so that what H leaves open stays where it is.
  const Eigen::VectorXd gradient = linear - hessian * x;
  Eigen::VectorXd g(count);
  for (Eigen::Index i = 0; i < count; ++i) g[i] = gradient[free[i]];
  return h.llt().solve(g);
}

}  // namespace

Eigen::VectorXd solveBounded(const Eigen::MatrixXd& hessian_in, const Eigen::VectorXd& linear_in,
                             const Eigen::VectorXd& start, const Eigen::VectorXd& low, const Eigen::VectorXd& high) {
  const Eigen::Index count = start.size();
  assert(hessian_in.rows() == count && hessian_in.cols() == count && linear_in.size() == count);
  assert(low.size() == count && high.size() == count && (low.array() < high.array()).all());
  Eigen::VectorXd x = start.cwiseMax(low).cwiseMin(high);
  const double scale = count == 0 ? 0.0 : hessian_in.diagonal().maxCoeff();
  if (scale <= 0.0) return x;
  Eigen::MatrixXd hessian = hessian_in;
  hessian.diagonal().array() += kRidge * scale;
  const Eigen::VectorXd linear = linear_in + kRidge * scale * x;
  const double tolerance = kGradientTolerance * std::max(scale, linear.cwiseAbs().maxCoeff());

  std::vector<bool> bound(static_cast<std::size_t>(count));
  for (Eigen::Index i = 0; i < count; ++i) bound[static_cast<std::size_t>(i)] = x[i] <= low[i] || x[i] >= high[i];
  for (Eigen::Index step = 0; step < 20 * count + 100; ++step) {
    std::vector<int> free;
    for (Eigen::Index i = 0; i < count; ++i) {
      if (!bound[static_cast<std::size_t>(i)]) free.push_back(static_cast<int>(i));
    }
    const Eigen::VectorXd move = solveFree(hessian, linear, x, free);
    // As far towards the free optimum as the bounds let all go together.
    double reach = 1.0;
    int stopped = -1;
    for (std::size_t i = 0; i < free.size(); ++i) {
      const auto index = static_cast<Eigen::Index>(i);
      const double room = (move[index] > 0.0 ? high : low)[free[i]] - x[free[i]];
      if (std::abs(move[index]) <= std::abs(room)) continue;
      const double share = room / move[index];
      if (share < reach || stopped < 0) reach = share, stopped = free[i];
    }
    for (std::size_t i = 0; i < free.size(); ++i) x[free[i]] += reach * move[static_cast<Eigen::Index>(i)];
    x = x.cwiseMax(low).cwiseMin(high);
    if (stopped >= 0) {
      x[stopped] = (x[stopped] - low[stopped] < high[stopped] - x[stopped] ? low : high)[stopped];
      bound[static_cast<std::size_t>(stopped)] = true;
      continue;
    }
    // Optimal for the free ones: release the bound that holds back most, if any does.
    const Eigen::VectorXd gradient = linear - hessian * x;
    double most = tolerance;
    Eigen::Index release = -1;
    for (Eigen::Index i = 0; i < count; ++i) {
      if (!bound[static_cast<std::size_t>(i)]) continue;
      const double pull = x[i] <= low[i] ? gradient[i] : -gradient[i];
      if (pull > most) most = pull, release = i;
    }
    if (release < 0) return x;
    bound[static_cast<std::size_t>(release)] = false;
  }
  throw SolverError("bounded least squares", static_cast<long>(count), std::nan(""));
}

Eigen::VectorXd solveBounded(const Eigen::MatrixXd& hessian, const Eigen::VectorXd& linear,
                             const Eigen::VectorXd& start, double low, double high) {
  const Eigen::VectorXd ones = Eigen::VectorXd::Ones(start.size());
  return solveBounded(hessian, linear, start, Eigen::VectorXd(low * ones), Eigen::VectorXd(high * ones));
}

}  // namespace facezip::geometry
