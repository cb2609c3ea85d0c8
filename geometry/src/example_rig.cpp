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

class Fit {
 public:
  Fit(const RigProblem& problem, const ExampleRigOptions& options)
      : problem_(problem),
        options_(options),
        gradient_(problem.neutral, problem.triangles),
        solver_(gradient_, problem.triangles, kScreening * boundingDiagonal(problem.neutral)),
        shapes_(static_cast<Eigen::Index>(problem.template_shapes.size())),
        examples_(static_cast<Eigen::Index>(problem.examples.size())) {}

  ExampleRig run(const std::function<void(int)>& step) {
    transfer();
    const double closeness = chooseCloseness();
    for (int i = 0; i < options_.iterations; ++i) {
      if (step) step(i);
      fitShapes(between(options_.shape_prior_fall * closeness, closeness, i, options_.iterations));
      fitWeights(between(options_.weight_prior_start, options_.weight_prior_end, i, options_.iterations));
    }
    rig_.degenerate_triangles = gradient_.degenerateTriangles();
    return std::move(rig_);
  }

 private:
  /// The template on the subject, and how well that poses the examples already.
  void transfer() {
    using Transfer = ShapeTransfer;
    Start gradients = bestWeights(
        transferShapes(problem_.template_neutral, problem_.template_shapes, problem_.neutral, problem_.triangles));
    Start displacements = bestWeights(displacedShapes());
    rig_.gradients_rms = gradients.rms;
    rig_.displacements_rms = displacements.rms;
    rig_.transfer = options_.transfer != Transfer::kBest ? options_.transfer
                    : displacements.rms < gradients.rms  ? Transfer::kDisplacements
                                                         : Transfer::kGradients;
    Start& start = rig_.transfer == Transfer::kGradients ? gradients : displacements;
    rig_.transferred = std::move(start.shapes);
    rig_.transferred_weights = std::move(start.weights);
    rig_.examples = std::move(start.examples);
    rig_.head_motions = std::move(start.motions);
    rig_.rigid_share = start.rigid_share;
    rig_.template_residuals = std::move(start.residuals);
    rig_.shapes = rig_.transferred;
    anchorWeights();
    rig_.weights = anchor_;
    measure(WeightSolver(problem_.neutral, rig_.shapes));
    differentiate();
  }

  /// What weights are held to. A guess is rough, mostly where it should be 0, and shapes would grow to suit it: a
  /// bounded fit of the transferred shapes, which a guess only nudges, is nearer the truth than either alone.
  void anchorWeights() {
    anchor_ = rig_.transferred_weights;
    if (problem_.guess.rows() == 0) return;
    const WeightSolver weights(problem_.neutral, rig_.transferred);
    for (Eigen::Index n = 0; n < examples_; ++n) {
      const auto& example = rig_.examples[static_cast<std::size_t>(n)];
      anchor_.row(n) =
          weights.solve(weights.project(example), problem_.guess.row(n).transpose(), options_.guess_prior).transpose();
    }
  }

  std::vector<Eigen::MatrixX3d> displacedShapes() const {
    const Similarity place = fitSimilarity(problem_.template_neutral, problem_.neutral);
    std::vector<Eigen::MatrixX3d> shapes;
    for (const Eigen::MatrixX3d& shape : problem_.template_shapes) {
      const Eigen::MatrixX3d moved = shape - problem_.template_neutral;
      const Eigen::VectorXd moving = 1.0 - stillVertices(problem_.template_neutral, moved).array();
      shapes.push_back(moving.asDiagonal() * place.applyToVectors(moved));
    }
    return shapes;
  }

  struct Start {
    std::vector<Eigen::MatrixX3d> shapes;
    Eigen::MatrixXd weights;
    std::vector<Eigen::MatrixX3d> examples;
    std::vector<Similarity> motions;
    std::vector<Distances> residuals;
    double rms = 0.0;
    double rigid_share = 0.0;
  };

  /// The bounded fit of shapes as they are.
  Start bestWeights(std::vector<Eigen::MatrixX3d> shapes) const {
    const WeightSolver rig(problem_.neutral, shapes);
    Start start;
    start.shapes = std::move(shapes);
    start.weights.resize(examples_, shapes_);
    start.examples = problem_.examples;
    double squares = 0.0;
    RigidShare rigid;
    const HeadStabiliser stabiliser(rig);
    for (Eigen::Index n = 0; n < examples_; ++n) {
      Eigen::MatrixX3d& example = start.examples[static_cast<std::size_t>(n)];
      Eigen::VectorXd w;
      if (options_.head_motion) {
        StabilisedMesh stabilised = stabiliser.stabilise(example);
        example = std::move(stabilised.mesh);
        start.motions.push_back(stabilised.motion);
        w = std::move(stabilised.weights);
      } else {
        w = rig.solve(rig.project(example), Eigen::VectorXd::Zero(shapes_), 0.0);
      }
      start.weights.row(n) = w.transpose();
      const Eigen::MatrixX3d posed = rig.pose(w);
      start.residuals.push_back(distancesBetween(posed, example));
      squares += start.residuals.back().rms * start.residuals.back().rms;
      rigid.add(rig, posed, example);
    }
    start.rms = std::sqrt(squares / static_cast<double>(examples_));
    start.rigid_share = rigid.value();
    return start;
  }

  void differentiate() {
    prior_.resize(2 * gradient_.triangles(), 3 * shapes_);
    still_.resize(gradient_.vertices(), shapes_);
    for (Eigen::Index m = 0; m < shapes_; ++m) {
      const auto& shape = problem_.template_shapes[static_cast<std::size_t>(m)];
      prior_.middleCols<3>(3 * m) = gradient_.of(rig_.transferred[static_cast<std::size_t>(m)]);
      still_.col(m) = stillVertices(problem_.template_neutral, shape - problem_.template_neutral);
    }
    observeExamples();
  }

  void observeExamples() {
    observed_.resize(2 * gradient_.triangles(), 3 * examples_);
    for (Eigen::Index n = 0; n < examples_; ++n) {
      observed_.middleCols<3>(3 * n) = gradient_.of(rig_.examples[static_cast<std::size_t>(n)] - problem_.neutral);
    }
  }

  /// The heads' motions again, with the shapes as they have become: the template's explained less of the expression.
  void followHeads(const WeightSolver& rig) {
    for (Eigen::Index n = 0; n < examples_; ++n) {
      const auto i = static_cast<std::size_t>(n);
      rig_.head_motions[i] = rig.headMotion(rig.pose(rig_.weights.row(n).transpose()), problem_.examples[i]);
      rig_.examples[i] = undo(rig_.head_motions[i], problem_.examples[i]);
    }
    observeExamples();
  }

  /// Residuals of the examples with the current weights.
  void measure(const WeightSolver& weights) {
    rig_.residuals.resize(problem_.examples.size());
    double squares = 0.0;
    for (Eigen::Index n = 0; n < examples_; ++n) {
      Distances& residual = rig_.residuals[static_cast<std::size_t>(n)];
      residual =
          distancesBetween(weights.pose(rig_.weights.row(n).transpose()), rig_.examples[static_cast<std::size_t>(n)]);
      squares += residual.rms * residual.rms;
    }
    rig_.convergence.push_back(std::sqrt(squares / static_cast<double>(examples_)));
  }

  /// Shapes that explain the examples' gradients with the weights as they are, near the transferred ones (Eq. 4 to 6).
  void fitShapes(double closeness) {
    Eigen::MatrixXd wanted = prior_;
    tbb::parallel_for(Eigen::Index{0}, gradient_.triangles(),
                      [&](Eigen::Index t) { fitTriangle(t, closeness, wanted); });
    Eigen::MatrixXd start(gradient_.vertices(), 3 * shapes_);
    for (Eigen::Index m = 0; m < shapes_; ++m) {
      start.middleCols<3>(3 * m) = rig_.shapes[static_cast<std::size_t>(m)];
    }
    const Eigen::MatrixXd solved = solveShapes(solver_, wanted, still_, start, kRounds);
    for (Eigen::Index m = 0; m < shapes_; ++m) {
      rig_.shapes[static_cast<std::size_t>(m)] = solved.middleCols<3>(3 * m);
    }
  }

  /// One triangle's part of Eq. 4 to 6: minimise  sum_n |R_n - sum_m b_nm X_m|^2 + closeness sum_m w_m |X_m - X*_m|^2.
  struct TriangleSystem {
    Eigen::Matrix<double, Eigen::Dynamic, 6> prior;   ///< X*, M by 6
    Eigen::Matrix<double, Eigen::Dynamic, 6> missed;  ///< R - B X*, N by 6
    Eigen::MatrixXd spread;  ///< D B^T, M by N, D = diag(1 / (closeness w_m)), 0 where the shape is still
    Eigen::MatrixXd system;  ///< B D B^T + I, N by N
  };

  TriangleSystem systemOf(Eigen::Index t, double closeness) const {
    TriangleSystem found;
    found.prior.resize(shapes_, 6);
    found.missed.resize(examples_, 6);
    for (Eigen::Index m = 0; m < shapes_; ++m) found.prior.row(m) << entry(prior_, t, m);
    for (Eigen::Index n = 0; n < examples_; ++n) found.missed.row(n) << entry(observed_, t, n);
    found.missed -= rig_.weights * found.prior;
    Eigen::VectorXd freedom(shapes_);
    for (Eigen::Index m = 0; m < shapes_; ++m) {
      const double strain = found.prior.row(m).norm();
      const double weight = std::pow((1.0 + strain) / (options_.kappa + strain), options_.theta);  // Eq. 6
      freedom[m] = isStill(t, m) ? 0.0 : 1.0 / (closeness * weight);
    }
    found.spread = freedom.asDiagonal() * rig_.weights.transpose();
    found.system = rig_.weights * found.spread;
    found.system.diagonal().array() += 1.0;
    return found;
  }

  /// X = X* + D B^T (B D B^T + I)^-1 (R - B X*).
  void fitTriangle(Eigen::Index t, double closeness, Eigen::MatrixXd& wanted) const {
    const TriangleSystem s = systemOf(t, closeness);
    const Eigen::Matrix<double, Eigen::Dynamic, 6> fitted = s.prior + s.spread * s.system.llt().solve(s.missed);
    for (Eigen::Index m = 0; m < shapes_; ++m) {
      wanted.block<1, 3>(2 * t, 3 * m) = fitted.row(m).head<3>();
      wanted.block<1, 3>(2 * t + 1, 3 * m) = fitted.row(m).tail<3>();
    }
  }

  /// The closeness with which every example's gradients are predicted best from the other examples: the error of
  /// leaving n out is (S^-1 (R - B X*))_n / (S^-1)_nn with the triangle's system S (Rasmussen and Williams 2006,
  /// Eq. 5.12).
  double chooseCloseness() {
    const Eigen::Index stride = std::max<Eigen::Index>(1, gradient_.triangles() / kTriangles);
    const Eigen::Index count = (gradient_.triangles() + stride - 1) / stride;
    const auto leftOut = [&](double closeness) {
      Eigen::VectorXd errors(count), nothing(count);  // summed in order, whatever the number of threads
      tbb::parallel_for(Eigen::Index{0}, count, [&](Eigen::Index i) {
        const TriangleSystem s = systemOf(i * stride, closeness);
        const Eigen::MatrixXd inverse = s.system.llt().solve(Eigen::MatrixXd::Identity(examples_, examples_));
        const auto squares = (inverse * s.missed).rowwise().squaredNorm().array();
        const double area = gradient_.areas()[i * stride];
        errors[i] = area * (squares / inverse.diagonal().array().square()).sum();
        nothing[i] = area * s.missed.squaredNorm();
      });
      rig_.left_out_template = std::sqrt(nothing.sum());
      return std::sqrt(errors.sum());
    };
    // Two examples predict each other too badly to choose by.
    if (options_.shape_prior || examples_ < 3) {
      rig_.shape_prior = options_.shape_prior.value_or(kUsualCloseness);
      rig_.left_out = leftOut(rig_.shape_prior);
      return rig_.shape_prior;
    }
    std::vector<double> errors;
    for (const double closeness : kCloseness) errors.push_back(leftOut(closeness));
    const double most = kAsGood * *std::min_element(errors.begin(), errors.end());
    for (std::size_t i = 0; i < errors.size(); ++i) {
      if (errors[i] <= most) rig_.left_out = errors[i], rig_.shape_prior = kCloseness[i];
    }
    return rig_.shape_prior;
  }

  /// The six derivatives of a field on a triangle.
  static Eigen::Matrix<double, 1, 6> entry(const Eigen::MatrixXd& fields, Eigen::Index t, Eigen::Index field) {
    Eigen::Matrix<double, 1, 6> six;
    six << fields.block<1, 3>(2 * t, 3 * field), fields.block<1, 3>(2 * t + 1, 3 * field);
    return six;
  }

  bool isStill(Eigen::Index t, Eigen::Index m) const {
    const auto& corners = problem_.triangles.row(t);
    return still_(corners[0], m) > 0.0 && still_(corners[1], m) > 0.0 && still_(corners[2], m) > 0.0;
  }

  /// The examples' weights with the shapes as they are, near where they began (Eq. 7, 8).
  void fitWeights(double strength) {
    const WeightSolver weights(problem_.neutral, rig_.shapes);
    for (Eigen::Index n = 0; n < examples_; ++n) {
      rig_.weights.row(n) =
          weights
              .solve(weights.project(rig_.examples[static_cast<std::size_t>(n)]), anchor_.row(n).transpose(), strength)
              .transpose();
    }
    if (options_.head_motion) followHeads(weights);
    measure(weights);
  }

  const RigProblem& problem_;
  const ExampleRigOptions& options_;
  SurfaceGradient gradient_;
  ScreenedPoisson solver_;
  Eigen::Index shapes_, examples_;  ///< M and N
  Eigen::MatrixXd prior_;           ///< 2 #T by 3 M: gradients of the transferred shapes
  Eigen::MatrixXd observed_;        ///< 2 #T by 3 N: of the examples
  Eigen::MatrixXd still_;           ///< #V by M: 1 where the shape moves nothing
  Eigen::MatrixXd anchor_;          ///< N by M: what the weights are held to
  ExampleRig rig_;
};

}  // namespace

ExampleRig fitExampleRig(const RigProblem& problem, const ExampleRigOptions& options,
                         const std::function<void(int)>& step) {
  requireConsistent(problem);
  return Fit(problem, options).run(step);
}

}  // namespace facezip::geometry
