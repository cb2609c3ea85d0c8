#include "facezip/geometry/example_rig.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "facezip/error.hpp"
#include "test_meshes.hpp"

namespace facezip::geometry {
namespace {

constexpr int kSide = 15;

Eigen::MatrixX3d bumpAt(double cx, double cy, const Eigen::RowVector3d& direction) {
  Eigen::MatrixX3d moved = Eigen::MatrixX3d::Zero(kSide * kSide, 3);
  for (int v = 0; v < kSide * kSide; ++v) {
    const double r = std::hypot(v % kSide - cx, v / kSide - cy) / 4.5;
    if (r < 1) moved.row(v) = (1 - r) * (1 - r) * direction;
  }
  return moved;
}

/// A template of six bumps; the subject's differ smoothly from them; ten examples mix the subject's.
struct Subject {
  RigProblem problem;
  std::vector<Eigen::MatrixX3d> shapes;  ///< the subject's true ones
  Eigen::MatrixXd weights;               ///< true, N by M

  explicit Subject(int examples = 10) {
    const TriangleMesh mesh = test::makeSheet(kSide, kSide);
    problem.neutral = mesh.positions;
    problem.triangles = mesh.triangles;
    problem.template_neutral = mesh.positions;
    const double centres[6][2] = {{4, 4}, {10, 4}, {7, 7}, {4, 10}, {10, 10}, {7, 4}};
    std::mt19937 random(4);
    std::uniform_real_distribution<double> uniform;
    for (int m = 0; m < 6; ++m) {
      const Eigen::RowVector3d direction(std::cos(m), std::sin(m), 1.0);
      problem.template_shapes.push_back(mesh.positions + bumpAt(centres[m][0], centres[m][1], direction));
      shapes.push_back(bumpAt(centres[m][0], centres[m][1],
                              1.2 * direction + 0.3 * Eigen::RowVector3d(std::sin(3 * m), 0.5, -std::cos(m))));
    }
    weights.setZero(examples, 6);
    for (int n = 0; n < examples; ++n) {
      Eigen::MatrixX3d example = mesh.positions;
      for (int m = 0; m < 6; ++m) {
        weights(n, m) = uniform(random) < 0.5 ? 0.0 : uniform(random);
        example += weights(n, m) * shapes[static_cast<std::size_t>(m)];
      }
      problem.examples.push_back(example);
    }
  }

  double shapeError(const std::vector<Eigen::MatrixX3d>& found) const {
    double error = 0.0;
    for (std::size_t m = 0; m < shapes.size(); ++m) error += (found[m] - shapes[m]).squaredNorm();
    return std::sqrt(error);
  }
};

TEST(ExampleRig, ComesCloserToTheSubjectThanTheTemplate) {
  const Subject subject;
  for (const ShapeTransfer transfer : {ShapeTransfer::kGradients, ShapeTransfer::kDisplacements}) {
    ExampleRigOptions options;
    options.transfer = transfer;
    const ExampleRig rig = fitExampleRig(subject.problem, options);
    EXPECT_LT(subject.shapeError(rig.shapes), 0.7 * subject.shapeError(rig.transferred));
    EXPECT_EQ(rig.convergence.size(), 11u);
    EXPECT_LT(rig.convergence.back(), 0.35 * rig.convergence.front());
    for (std::size_t n = 0; n < rig.residuals.size(); ++n) {
      EXPECT_LT(rig.residuals[n].rms, rig.template_residuals[n].rms + 1e-9) << n;
      EXPECT_LE(rig.residuals[n].mean, rig.residuals[n].percentile_99);
      EXPECT_LE(rig.residuals[n].percentile_99, rig.residuals[n].largest);
    }
    EXPECT_GE(rig.weights.minCoeff(), 0.0);
    EXPECT_LE(rig.weights.maxCoeff(), 1.0);
  }
}

TEST(ExampleRig, RecoversWeightsFromARoughGuess) {
  Subject subject;
  std::mt19937 random(9);
  std::uniform_real_distribution<double> disturb(-0.2, 0.2);
  subject.problem.guess = subject.weights;
  for (double& weight : subject.problem.guess.reshaped()) weight = std::clamp(weight + disturb(random), 0.0, 1.0);
  const ExampleRig rig = fitExampleRig(subject.problem, {});
  const double before = (subject.problem.guess - subject.weights).cwiseAbs().mean();
  const double after = (rig.weights - subject.weights).cwiseAbs().mean();
  EXPECT_LT(after, 0.9 * before);
  EXPECT_LT(subject.shapeError(rig.shapes), 0.8 * subject.shapeError(rig.transferred));
}

TEST(ExampleRig, TakesTheHeadsMotionOut) {
  const Subject subject;
  const ExampleRig still = fitExampleRig(subject.problem, {});
  EXPECT_LT(still.rigid_share, 0.5);
  EXPECT_TRUE(still.head_motions.empty());

  RigProblem moved = subject.problem;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::vector<Similarity> motions(moved.examples.size());
  for (std::size_t n = 0; n < motions.size(); ++n) {
    const Eigen::Vector3d axis(uniform(random), uniform(random), uniform(random));
    motions[n].turn = Eigen::AngleAxisd(0.1 * uniform(random), axis.normalized()).matrix();
    motions[n].shift << uniform(random), uniform(random), uniform(random);
    moved.examples[n] = motions[n].apply(moved.examples[n]);
  }
  EXPECT_GT(fitExampleRig(moved, {}).rigid_share, 0.5);

  ExampleRigOptions options;
  options.head_motion = true;
  const ExampleRig rig = fitExampleRig(moved, options);
  // Without following the heads as the shapes change it would be 1.009.
  EXPECT_LT(subject.shapeError(rig.shapes), 1.005 * subject.shapeError(still.shapes));
  EXPECT_LT((rig.weights - subject.weights).cwiseAbs().mean(),
            1.2 * (still.weights - subject.weights).cwiseAbs().mean());
  EXPECT_LT(rig.convergence.back(), 1.2 * still.convergence.back());
  ASSERT_EQ(rig.head_motions.size(), motions.size());
  for (std::size_t n = 0; n < motions.size(); ++n) {
    EXPECT_LT((rig.head_motions[n].turn - motions[n].turn).norm(), 0.02) << n;
    EXPECT_LT(distancesBetween(rig.examples[n], subject.problem.examples[n]).rms, 0.1) << n;
  }
}

TEST(ExampleRig, ATemplateThatIsTheSubjectStaysAsItIs) {
  Subject subject;
  for (std::size_t m = 0; m < subject.shapes.size(); ++m) {
    subject.problem.template_shapes[m] = subject.problem.neutral + subject.shapes[m];
  }
  const ExampleRig rig = fitExampleRig(subject.problem, {});
  EXPECT_LT((rig.weights - subject.weights).cwiseAbs().maxCoeff(), 1e-3);
  EXPECT_LT(subject.shapeError(rig.shapes), 1e-3);
}

TEST(ExampleRig, OneTriangleIsFittedAsTheNormalEquationsSay) {
  // A single triangle without still corners, one shape, one example: the minimum of
  //   |r - b x|^2 + closeness w |x - x*|^2  is  (b r + closeness w x*) / (b^2 + closeness w)  for every derivative.
  RigProblem problem;
  problem.neutral.resize(3, 3);
  problem.neutral << 0, 0, 0, 1, 0, 0, 0, 1, 0;
  problem.triangles.resize(1, 3);
  problem.triangles << 0, 1, 2;
  problem.template_neutral = problem.neutral;
  Eigen::Matrix3d stretch = Eigen::Vector3d(1.2, 1, 1).asDiagonal();
  const Eigen::RowVector3d away(0.1, 0.1, 0.3);
  problem.template_shapes = {(problem.neutral * stretch).rowwise() + away};
  Eigen::Matrix3d more = Eigen::Vector3d(1.4, 1, 1).asDiagonal();
  problem.examples = {(problem.neutral * more).rowwise() + away};
  problem.guess = Eigen::MatrixXd::Constant(1, 1, 0.5);
  ExampleRigOptions options;
  options.iterations = 8;  // each goes most of the rest of the way, as nothing is still
  options.shape_prior = 0.3;
  options.shape_prior_fall = 1.0;
  options.guess_prior = options.weight_prior_start = options.weight_prior_end = 1e9;  // the weight is the guess
  options.transfer = ShapeTransfer::kDisplacements;
  const ExampleRig rig = fitExampleRig(problem, options);
  const SurfaceGradient gradient(problem.neutral, problem.triangles);
  const Eigen::MatrixXd prior = gradient.of(rig.transferred[0]);
  const Eigen::MatrixXd observed = gradient.of(problem.examples[0] - problem.neutral);
  const double weight = 0.3 * std::pow((1 + prior.norm()) / (options.kappa + prior.norm()), options.theta);
  const Eigen::MatrixXd expected = (0.5 * observed + weight * prior) / (0.25 + weight);
  EXPECT_LT((gradient.of(rig.shapes[0]) - expected).norm(), 1e-3 * (expected - prior).norm());
}

TEST(ExampleRig, StaysNearTheTemplateWhereExamplesTellNothingOfTheShapes) {
  Subject personal(20), noisy(20);
  // The template's shapes, performed with a change of its own in every example.
  std::mt19937 random(5);
  std::normal_distribution<double> change(0.0, 0.15);
  for (std::size_t n = 0; n < noisy.problem.examples.size(); ++n) {
    noisy.problem.examples[n] = noisy.problem.neutral;
    for (std::size_t m = 0; m < noisy.shapes.size(); ++m) {
      noisy.shapes[m] = noisy.problem.template_shapes[m] - noisy.problem.neutral;
      const Eigen::Vector3d own(1 + change(random), 1 + change(random), 1 + change(random));
      noisy.problem.examples[n] += noisy.weights(static_cast<Eigen::Index>(n), static_cast<Eigen::Index>(m)) *
                                   noisy.shapes[m] * own.asDiagonal();
    }
  }
  const ExampleRig free = fitExampleRig(personal.problem, {}), held = fitExampleRig(noisy.problem, {});
  EXPECT_LE(free.shape_prior, 0.03);
  EXPECT_LT(free.left_out, 0.7 * free.left_out_template);
  EXPECT_GE(held.shape_prior, 10 * free.shape_prior);
  ExampleRigOptions options;
  options.shape_prior = free.shape_prior;
  const ExampleRig loose = fitExampleRig(noisy.problem, options);
  EXPECT_LT(noisy.shapeError(held.shapes), 0.8 * noisy.shapeError(loose.shapes));
}

TEST(ExampleRig, ShapesThatNoExampleShowsKeepTheTemplates) {
  Subject subject;
  subject.problem.template_shapes.push_back(subject.problem.neutral);  // moves nothing
  subject.problem.template_shapes.push_back(subject.problem.neutral + bumpAt(12, 12, {5, 5, 5}));
  const ExampleRig rig = fitExampleRig(subject.problem, {});
  EXPECT_EQ(rig.shapes[6].norm(), 0.0);
  EXPECT_TRUE(rig.weights.allFinite());
  EXPECT_LT((rig.shapes[7] - rig.transferred[7]).norm(), 0.25 * rig.transferred[7].norm());
}

TEST(ExampleRig, OneExampleIsEnoughToRun) {
  const Subject subject(1);
  const ExampleRig rig = fitExampleRig(subject.problem, {});
  EXPECT_LT(rig.residuals[0].rms, rig.template_residuals[0].rms + 1e-9);
}

TEST(ExampleRig, RefusesWhatDoesNotFit) {
  const auto refuses = [](const auto& spoil) {
    Subject subject;
    spoil(subject.problem);
    EXPECT_THROW(fitExampleRig(subject.problem, {}), InputError);
  };
  refuses([](RigProblem& p) { p.examples.clear(); });
  refuses([](RigProblem& p) { p.template_shapes.clear(); });
  refuses([](RigProblem& p) { p.template_neutral = p.template_neutral.topRows(5).eval(); });
  refuses([](RigProblem& p) { p.template_shapes[2].conservativeResize(7, 3); });
  refuses([](RigProblem& p) { p.examples[1](3, 0) = std::numeric_limits<double>::quiet_NaN(); });
  refuses([](RigProblem& p) { p.guess = Eigen::MatrixXd::Zero(2, 2); });
  refuses([](RigProblem& p) { p.guess = Eigen::MatrixXd::Constant(10, 6, 1.5); });
}

TEST(WeightSolver, FindsThePoseAndTheMotionOfTheHead) {
  const Subject subject;
  const WeightSolver solver(subject.problem.neutral, subject.shapes);
  const Eigen::VectorXd weights = subject.weights.row(4).transpose();
  const Eigen::MatrixX3d posed = solver.pose(weights);
  EXPECT_LT((posed - subject.problem.examples[4]).cwiseAbs().maxCoeff(), 1e-12);
  const Eigen::VectorXd found = solver.solve(solver.project(posed), Eigen::VectorXd::Zero(6), 0.0);
  EXPECT_LT((found - weights).cwiseAbs().maxCoeff(), 1e-6);
  Similarity motion;
  motion.turn = Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitY()).matrix();
  motion.shift << 1, 2, 3;
  const Similarity again = solver.headMotion(posed, motion.apply(posed));
  EXPECT_LT((undo(again, motion.apply(posed)) - posed).cwiseAbs().maxCoeff(), 1e-9);
}

}  // namespace
}  // namespace facezip::geometry
