// Li, Weise and Pauly 2010, with three differences: gradients of displacements stand for their frames, which says the
// same of a triangle without its normal; and a triangle's M unknowns are found from N by N systems (the identity of
// Woodbury), N being the few examples, so that the closeness may have weights of its own at every triangle; and weights
// are held to a bounded fit of the transferred shapes near the guess, not to the guess itself.
#include "facezip/geometry/example_rig.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cassert>
#include <cmath>

#include "facezip/error.hpp"

namespace facezip::geometry {
namespace {

constexpr double kScreening = 0.25;  // of the mesh's diagonal
constexpr int kRounds = 3;           // of still vertices, per iteration
// Of the shapes' closeness, from free to the template's own; and how many triangles they are tried on.
constexpr double kCloseness[] = {0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0};
// Errors within this factor of the least are as good: of these the template's nearest is the safest.
constexpr double kAsGood = 1.02;
constexpr double kUsualCloseness = 0.03;
constexpr Eigen::Index kTriangles = 4000;

double between(double start, double end, int step, int steps) {
  return steps <= 1 ? end : start * std::pow(end / start, static_cast<double>(step) / (steps - 1));
}

void requireConsistent(const RigProblem& problem) {
  const Eigen::Index vertices = problem.neutral.rows();
  const auto require = [](bool holds, const char* item, const std::string& expected, const std::string& got) {
    if (!holds) throw InputError({"", item, expected, got, ""});
  };
  require(!problem.examples.empty(), "examples", "at least one", "none");
  require(!problem.template_shapes.empty(), "template", "at least one shape", "none");
  require(problem.template_neutral.rows() == vertices, "template", fmt::format("{} vertices", vertices),
          fmt::format("{}", problem.template_neutral.rows()));
  for (const auto* meshes : {&problem.template_shapes, &problem.examples}) {
    for (const Eigen::MatrixX3d& mesh : *meshes) {
      require(mesh.rows() == vertices, "mesh", fmt::format("{} vertices", vertices), fmt::format("{}", mesh.rows()));
      require(mesh.allFinite(), "mesh", "finite coordinates", "NaN or infinity");
    }
  }
  require(problem.neutral.allFinite() && problem.template_neutral.allFinite(), "neutral", "finite coordinates",
          "NaN or infinity");
  if (problem.guess.rows() == 0) return;
  require(problem.guess.rows() == static_cast<Eigen::Index>(problem.examples.size()) &&
              problem.guess.cols() == static_cast<Eigen::Index>(problem.template_shapes.size()),
          "guess", fmt::format("{} by {} weights", problem.examples.size(), problem.template_shapes.size()),
          fmt::format("{} by {}", problem.guess.rows(), problem.guess.cols()));
  require(problem.guess.allFinite() && problem.guess.minCoeff() >= 0.0 && problem.guess.maxCoeff() <= 1.0, "guess",
          "weights from 0 to 1", "others");
}

/// The template on the subject, and how well that poses the examples already.
struct Start {
  std::vector<Eigen::MatrixX3d> shapes;    ///< M displacements
  Eigen::MatrixXd weights;                 ///< N by M, of a bounded fit
  std::vector<Eigen::MatrixX3d> examples;  ///< N, without the heads' motions where those are taken out
  std::vector<Similarity> motions;         ///< N, or empty
  std::vector<Distances> residuals;
  double rms = 0.0;
  double rigid_share = 0.0;
};

/// The bounded fit of shapes as they are.
Start bestWeights(const RigProblem& problem, std::vector<Eigen::MatrixX3d> shapes, bool head_motion) {
  const WeightSolver rig(problem.neutral, shapes);
  const auto count = static_cast<Eigen::Index>(shapes.size());
  const auto examples = static_cast<Eigen::Index>(problem.examples.size());
  Start start;
  start.shapes = std::move(shapes);
  start.weights.resize(examples, count);
  start.examples = problem.examples;
  double squares = 0.0;
  RigidShare rigid;
  const HeadStabiliser stabiliser(rig);
  for (Eigen::Index n = 0; n < examples; ++n) {
    Eigen::MatrixX3d& example = start.examples[static_cast<std::size_t>(n)];
    Eigen::VectorXd w;
    if (head_motion) {
      StabilisedMesh stabilised = stabiliser.stabilise(example);
      example = std::move(stabilised.mesh);
      start.motions.push_back(stabilised.motion);
      w = std::move(stabilised.weights);
    } else {
      w = rig.solve(rig.project(example), Eigen::VectorXd::Zero(count), 0.0);
    }
    start.weights.row(n) = w.transpose();
    const Eigen::MatrixX3d posed = rig.pose(w);
    start.residuals.push_back(distancesBetween(posed, example));
    squares += start.residuals.back().rms * start.residuals.back().rms;
    rigid.add(rig, posed, example);
  }
  start.rms = std::sqrt(squares / static_cast<double>(examples));
  start.rigid_share = rigid.value();
  return start;
}

/// What the fit takes as given.
struct Given {
  const RigProblem& problem;
  const ExampleRigOptions& options;
  const SurfaceGradient& gradient;
  const ScreenedPoisson& solver;
  Eigen::Index shapes, examples;  ///< M and N
  Eigen::MatrixXd prior;          ///< 2 #T by 3 M: gradients of the transferred shapes
  Eigen::MatrixXd still;          ///< #V by M: 1 where the shape moves nothing
  Eigen::MatrixXd anchor;         ///< N by M: what the weights are held to
};

/// What it changes, in turns.
struct Fitted {
  std::vector<Eigen::MatrixX3d> shapes;
  Eigen::MatrixXd weights;
  std::vector<Eigen::MatrixX3d> examples;
  std::vector<Similarity> head_motions;
  Eigen::MatrixXd observed;  ///< 2 #T by 3 N: gradients of the examples
  std::vector<Distances> residuals;
};

/// What weights are held to. A guess is rough, mostly where it should be 0, and shapes would grow to suit it: a
/// bounded fit of the transferred shapes, which a guess only nudges, is nearer the truth than either alone.
Eigen::MatrixXd anchorWeights(const RigProblem& problem, const Start& start, double guess_prior) {
  if (problem.guess.rows() == 0) return start.weights;
  const WeightSolver weights(problem.neutral, start.shapes);
  Eigen::MatrixXd anchor = start.weights;
  for (Eigen::Index n = 0; n < anchor.rows(); ++n) {
    const auto& example = start.examples[static_cast<std::size_t>(n)];
    anchor.row(n) = weights.solve(weights.project(example), problem.guess.row(n).transpose(), guess_prior).transpose();
  }
  return anchor;
}

Given givenOf(const RigProblem& problem, const ExampleRigOptions& options, const SurfaceGradient& gradient,
              const ScreenedPoisson& solver, const Start& start) {
  const auto shapes = static_cast<Eigen::Index>(start.shapes.size());
  Given given{problem,
              options,
              gradient,
              solver,
              shapes,
              static_cast<Eigen::Index>(start.examples.size()),
              Eigen::MatrixXd(2 * gradient.triangles(), 3 * shapes),
              Eigen::MatrixXd(gradient.vertices(), shapes),
              anchorWeights(problem, start, options.guess_prior)};
  for (Eigen::Index m = 0; m < shapes; ++m) {
    const auto i = static_cast<std::size_t>(m);
    given.prior.middleCols<3>(3 * m) = gradient.of(start.shapes[i]);
    given.still.col(m) = stillVertices(problem.template_neutral, problem.template_shapes[i] - problem.template_neutral);
  }
  return given;
}

Eigen::MatrixXd gradientsOf(const SurfaceGradient& gradient, const std::vector<Eigen::MatrixX3d>& examples,
                            const Eigen::MatrixX3d& neutral) {
  Eigen::MatrixXd gradients(2 * gradient.triangles(), 3 * static_cast<Eigen::Index>(examples.size()));
  for (std::size_t n = 0; n < examples.size(); ++n) {
    gradients.middleCols<3>(3 * static_cast<Eigen::Index>(n)) = gradient.of(examples[n] - neutral);
  }
  return gradients;
}

/// Residuals of the examples with the current weights. Returns their rms over all.
double measure(const WeightSolver& weights, Fitted& fitted) {
  fitted.residuals.resize(fitted.examples.size());
  double squares = 0.0;
  for (std::size_t n = 0; n < fitted.examples.size(); ++n) {
    Distances& residual = fitted.residuals[n];
    residual = distancesBetween(weights.pose(fitted.weights.row(static_cast<Eigen::Index>(n)).transpose()),
                                fitted.examples[n]);
    squares += residual.rms * residual.rms;
  }
  return std::sqrt(squares / static_cast<double>(fitted.examples.size()));
}

/// The six derivatives of a field on a triangle.
Eigen::Matrix<double, 1, 6> entry(const Eigen::MatrixXd& fields, Eigen::Index t, Eigen::Index field) {
  Eigen::Matrix<double, 1, 6> six;
  six << fields.block<1, 3>(2 * t, 3 * field), fields.block<1, 3>(2 * t + 1, 3 * field);
  return six;
}

bool isStill(const Given& given, Eigen::Index t, Eigen::Index m) {
  const auto& corners = given.problem.triangles.row(t);
  return given.still(corners[0], m) > 0.0 && given.still(corners[1], m) > 0.0 && given.still(corners[2], m) > 0.0;
}

/// One triangle's part of Eq. 4 to 6: minimise  sum_n |R_n - sum_m b_nm X_m|^2 + closeness sum_m w_m |X_m - X*_m|^2.
struct TriangleSystem {
  Eigen::Matrix<double, Eigen::Dynamic, 6> prior;   ///< X*, M by 6
  Eigen::Matrix<double, Eigen::Dynamic, 6> missed;  ///< R - B X*, N by 6
  Eigen::MatrixXd spread;  ///< D B^T, M by N, D = diag(1 / (closeness w_m)), 0 where the shape is still
  Eigen::MatrixXd system;  ///< B D B^T + I, N by N
};

TriangleSystem systemOf(const Given& given, const Fitted& fitted, Eigen::Index t, double closeness) {
  TriangleSystem found;
  found.prior.resize(given.shapes, 6);
  found.missed.resize(given.examples, 6);
  for (Eigen::Index m = 0; m < given.shapes; ++m) found.prior.row(m) << entry(given.prior, t, m);
  for (Eigen::Index n = 0; n < given.examples; ++n) found.missed.row(n) << entry(fitted.observed, t, n);
  found.missed -= fitted.weights * found.prior;
  Eigen::VectorXd freedom(given.shapes);
  for (Eigen::Index m = 0; m < given.shapes; ++m) {
    const double strain = found.prior.row(m).norm();
    const double weight = std::pow((1.0 + strain) / (given.options.kappa + strain), given.options.theta);  // Eq. 6
    freedom[m] = isStill(given, t, m) ? 0.0 : 1.0 / (closeness * weight);
  }
  found.spread = freedom.asDiagonal() * fitted.weights.transpose();
  found.system = fitted.weights * found.spread;
  found.system.diagonal().array() += 1.0;
  return found;
}

/// Shapes that explain the examples' gradients with the weights as they are, near the transferred ones (Eq. 4 to 6):
/// X = X* + D B^T (B D B^T + I)^-1 (R - B X*) at every triangle.
std::vector<Eigen::MatrixX3d> fitShapes(const Given& given, const Fitted& fitted, double closeness) {
  Eigen::MatrixXd wanted = given.prior;
  tbb::parallel_for(Eigen::Index{0}, given.gradient.triangles(), [&](Eigen::Index t) {
    const TriangleSystem s = systemOf(given, fitted, t, closeness);
    const Eigen::Matrix<double, Eigen::Dynamic, 6> solved = s.prior + s.spread * s.system.llt().solve(s.missed);
    for (Eigen::Index m = 0; m < given.shapes; ++m) {
      wanted.block<1, 3>(2 * t, 3 * m) = solved.row(m).head<3>();
      wanted.block<1, 3>(2 * t + 1, 3 * m) = solved.row(m).tail<3>();
    }
  });
  Eigen::MatrixXd start(given.gradient.vertices(), 3 * given.shapes);
  for (Eigen::Index m = 0; m < given.shapes; ++m) {
    start.middleCols<3>(3 * m) = fitted.shapes[static_cast<std::size_t>(m)];
  }
  const Eigen::MatrixXd solved = solveShapes(given.solver, wanted, given.still, start, kRounds);
  std::vector<Eigen::MatrixX3d> shapes;
  for (Eigen::Index m = 0; m < given.shapes; ++m) shapes.emplace_back(solved.middleCols<3>(3 * m));
  return shapes;
}

/// How close shapes stay to the template's, and how well that predicts examples from the others.
struct Closeness {
  double value = 0.0;
  double left_out = 0.0;  ///< error of the examples' gradients, each predicted from the others ...
  double nothing = 0.0;   ///< ... and of the transferred shapes alone
};

/// The error of leaving n out is (S^-1 (R - B X*))_n / (S^-1)_nn with the triangle's system S (Rasmussen and Williams
/// 2006, Eq. 5.12).
Closeness leaveOut(const Given& given, const Fitted& fitted, double closeness) {
  const Eigen::Index stride = std::max<Eigen::Index>(1, given.gradient.triangles() / kTriangles);
  const Eigen::Index count = (given.gradient.triangles() + stride - 1) / stride;
  Eigen::VectorXd errors(count), nothing(count);  // summed in order, whatever the number of threads
  tbb::parallel_for(Eigen::Index{0}, count, [&](Eigen::Index i) {
    const TriangleSystem s = systemOf(given, fitted, i * stride, closeness);
    const Eigen::MatrixXd inverse = s.system.llt().solve(Eigen::MatrixXd::Identity(given.examples, given.examples));
    const auto squares = (inverse * s.missed).rowwise().squaredNorm().array();
    const double area = given.gradient.areas()[i * stride];
    errors[i] = area * (squares / inverse.diagonal().array().square()).sum();
    nothing[i] = area * s.missed.squaredNorm();
  });
  return {closeness, std::sqrt(errors.sum()), std::sqrt(nothing.sum())};
}

/// The closeness with which every example's gradients are predicted best from the other examples.
Closeness chooseCloseness(const Given& given, const Fitted& fitted) {
  // Two examples predict each other too badly to choose by.
  if (given.options.shape_prior || given.examples < 3) {
    return leaveOut(given, fitted, given.options.shape_prior.value_or(kUsualCloseness));
  }
  std::vector<Closeness> tried;
  for (const double closeness : kCloseness) tried.push_back(leaveOut(given, fitted, closeness));
  const double most = kAsGood * std::ranges::min_element(tried, {}, &Closeness::left_out)->left_out;
  Closeness best = tried.front();
  for (const Closeness& one : tried) {
    if (one.left_out <= most) best = one;  // rising: the last of the good ones is the template's nearest
  }
  return best;
}

/// The heads' motions again, with the shapes as they have become: the template's explained less of the expression.
void followHeads(const Given& given, const WeightSolver& rig, Fitted& fitted) {
  for (std::size_t n = 0; n < fitted.examples.size(); ++n) {
    const Eigen::MatrixX3d posed = rig.pose(fitted.weights.row(static_cast<Eigen::Index>(n)).transpose());
    fitted.head_motions[n] = rig.headMotion(posed, given.problem.examples[n]);
    fitted.examples[n] = undo(fitted.head_motions[n], given.problem.examples[n]);
  }
  fitted.observed = gradientsOf(given.gradient, fitted.examples, given.problem.neutral);
}

/// The examples' weights with the shapes as they are, near where they began (Eq. 7, 8). Returns the rms that is left.
double fitWeights(const Given& given, double strength, Fitted& fitted) {
  const WeightSolver weights(given.problem.neutral, fitted.shapes);
  for (std::size_t n = 0; n < fitted.examples.size(); ++n) {
    const auto row = static_cast<Eigen::Index>(n);
    fitted.weights.row(row) =
        weights.solve(weights.project(fitted.examples[n]), given.anchor.row(row).transpose(), strength).transpose();
  }
  if (given.options.head_motion) followHeads(given, weights, fitted);
  return measure(weights, fitted);
}

}  // namespace

ExampleRig fitExampleRig(const RigProblem& problem, const ExampleRigOptions& options,
                         const std::function<void(int)>& step) {
  requireConsistent(problem);
  const SurfaceGradient gradient(problem.neutral, problem.triangles);
  const ScreenedPoisson solver(gradient, problem.triangles, kScreening * boundingDiagonal(problem.neutral));
  Start gradients = bestWeights(
      problem, transferShapes(problem.template_neutral, problem.template_shapes, problem.neutral, problem.triangles),
      options.head_motion);
  Start displacements =
      bestWeights(problem, displacedShapes(problem.template_neutral, problem.template_shapes, problem.neutral),
                  options.head_motion);
  ExampleRig rig;
  rig.gradients_rms = gradients.rms;
  rig.displacements_rms = displacements.rms;
  rig.transfer = options.transfer != ShapeTransfer::kBest ? options.transfer
                 : displacements.rms < gradients.rms      ? ShapeTransfer::kDisplacements
                                                          : ShapeTransfer::kGradients;
  Start& start = rig.transfer == ShapeTransfer::kGradients ? gradients : displacements;
  const Given given = givenOf(problem, options, gradient, solver, start);
  Fitted fitted{start.shapes,
                given.anchor,
                start.examples,
                start.motions,
                gradientsOf(gradient, start.examples, problem.neutral),
                {}};
  rig.convergence.push_back(measure(WeightSolver(problem.neutral, fitted.shapes), fitted));

  const Closeness closeness = chooseCloseness(given, fitted);
  for (int i = 0; i < options.iterations; ++i) {
    if (step) step(i);
    fitted.shapes = fitShapes(
        given, fitted, between(options.shape_prior_fall * closeness.value, closeness.value, i, options.iterations));
    rig.convergence.push_back(fitWeights(
        given, between(options.weight_prior_start, options.weight_prior_end, i, options.iterations), fitted));
  }
  rig.shapes = std::move(fitted.shapes);
  rig.weights = std::move(fitted.weights);
  rig.residuals = std::move(fitted.residuals);
  rig.examples = std::move(fitted.examples);
  rig.head_motions = std::move(fitted.head_motions);
  rig.transferred = std::move(start.shapes);
  rig.transferred_weights = std::move(start.weights);
  rig.template_residuals = std::move(start.residuals);
  rig.rigid_share = start.rigid_share;
  rig.shape_prior = closeness.value;
  rig.left_out = closeness.left_out;
  rig.left_out_template = closeness.nothing;
  rig.degenerate_triangles = gradient.degenerateTriangles();
  return rig;
}

}  // namespace facezip::geometry
