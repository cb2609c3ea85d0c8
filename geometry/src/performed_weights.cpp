#include "facezip/geometry/performed_weights.hpp"

#include <tbb/parallel_for.h>

#include "facezip/geometry/bounded_least_squares.hpp"

namespace facezip::geometry {
namespace {

/// Pull of weights that were not asked for to 0, of the squared length of the pose that was.
constexpr double kUnaskedPull = 0.03;
/// Pull of those that were to what was asked, likewise: it decides between shapes that undo each other (a jaw that
/// opens, lips that close over it), and hardly anything else.
constexpr double kAskedPull = 0.01;
/// A person's shape may go further than the template's.
constexpr double kMostWeight = 2.0;

Eigen::MatrixXf columnsOf(const std::vector<Eigen::MatrixX3f>& displacements) {
  Eigen::MatrixXf columns(displacements.front().size(), static_cast<Eigen::Index>(displacements.size()));
  for (std::size_t i = 0; i < displacements.size(); ++i) {
    columns.col(static_cast<Eigen::Index>(i)) = displacements[i].reshaped();
  }
  return columns;
}

}  // namespace

Eigen::MatrixXd performedWeights(const std::vector<Eigen::MatrixX3f>& shapes,
                                 const std::vector<Eigen::MatrixX3f>& examples, const Eigen::MatrixXd& asked,
                                 double performance) {
  const Eigen::MatrixXf basis = columnsOf(shapes);
  const Eigen::MatrixXd hessian = (basis.transpose() * basis).cast<double>();
  const Eigen::MatrixXd projected = (basis.transpose() * columnsOf(examples)).cast<double>();  // M by N
  const double nothing = 1e-9 * hessian.diagonal().maxCoeff();
  Eigen::MatrixXd weights(asked.rows(), asked.cols());
  tbb::parallel_for(Eigen::Index{0}, asked.rows(), [&](Eigen::Index e) {
    const Eigen::VectorXd want = asked.row(e).transpose();
    const double pose = want.dot(hessian * want);
    Eigen::VectorXd pull = Eigen::VectorXd::Constant(want.size(), nothing);
    for (Eigen::Index m = 0; m < want.size(); ++m) pull[m] += (want[m] > 0.0 ? kAskedPull : kUnaskedPull) * pose;
    Eigen::MatrixXd system = hessian;
    system.diagonal() += pull;
    const Eigen::VectorXd linear = projected.col(e) + pull.cwiseProduct(want);
    const Eigen::VectorXd fitted = solveBounded(system, linear, want, 0.0, kMostWeight);
    for (Eigen::Index m = 0; m < want.size(); ++m) {
      weights(e, m) = want[m] > 0.0 ? want[m] + performance * (fitted[m] - want[m]) : fitted[m];
    }
  });
  return weights;
}

}  // namespace facezip::geometry
