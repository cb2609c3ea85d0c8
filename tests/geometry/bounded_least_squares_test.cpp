#include "facezip/geometry/bounded_least_squares.hpp"

#include <gtest/gtest.h>

#include <random>

#include "../reference/bounded_least_squares.hpp"

namespace facezip::geometry {
namespace {

struct Problem {
  Eigen::MatrixXd hessian;
  Eigen::VectorXd linear;
};

Problem randomProblem(int unknowns, int equations, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  Eigen::MatrixXd a(equations, unknowns);
  Eigen::VectorXd b(equations);
  for (double& value : a.reshaped()) value = normal(random);
  for (double& value : b) value = 2.0 * normal(random);
  return {a.transpose() * a, a.transpose() * b};
}

double valueOf(const Problem& problem, const Eigen::VectorXd& x) {
  return 0.5 * x.dot(problem.hessian * x) - problem.linear.dot(x);
}

TEST(BoundedLeastSquares, ReachesTheBestOfAllActiveSets) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    const int unknowns = 1 + static_cast<int>(seed % 7);
    const Problem problem = randomProblem(unknowns, 9, seed);
    const Eigen::VectorXd x = solveBounded(problem.hessian, problem.linear, Eigen::VectorXd::Zero(unknowns), 0.0, 1.0);
    EXPECT_GE(x.minCoeff(), 0.0);
    EXPECT_LE(x.maxCoeff(), 1.0);
    reference::Square h(static_cast<std::size_t>(unknowns), std::vector<double>(static_cast<std::size_t>(unknowns)));
    std::vector<double> g(static_cast<std::size_t>(unknowns));
    for (int i = 0; i < unknowns; ++i) {
      g[static_cast<std::size_t>(i)] = problem.linear[i];
      for (int j = 0; j < unknowns; ++j)
        h[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] = problem.hessian(i, j);
    }
    EXPECT_NEAR(valueOf(problem, x), reference::smallestInBox(h, g, 0.0, 1.0), 1e-7) << seed;
  }
}

TEST(BoundedLeastSquares, TheStartDoesNotDecideWhatTheDataDo) {
  const Problem problem = randomProblem(20, 60, 5);
  const Eigen::VectorXd low = solveBounded(problem.hessian, problem.linear, Eigen::VectorXd::Zero(20), 0.0, 1.0);
  const Eigen::VectorXd high = solveBounded(problem.hessian, problem.linear, Eigen::VectorXd::Ones(20), 0.0, 1.0);
  EXPECT_LT((low - high).cwiseAbs().maxCoeff(), 1e-6);
}

TEST(BoundedLeastSquares, WhatTheDataLeaveOpenStaysAtTheStart) {
  Eigen::MatrixXd hessian = Eigen::MatrixXd::Zero(3, 3);
  hessian(0, 0) = 2.0;
  const Eigen::VectorXd x =
      solveBounded(hessian, Eigen::Vector3d(1.0, 0.0, 0.0), Eigen::Vector3d(0.0, 0.3, 7.0), 0.0, 1.0);
  EXPECT_NEAR(x[0], 0.5, 1e-9);
  EXPECT_EQ(x[1], 0.3);
  EXPECT_EQ(x[2], 1.0);  // clamped
  EXPECT_EQ(solveBounded(Eigen::MatrixXd::Zero(1, 1), Eigen::VectorXd::Zero(1), Eigen::VectorXd::Zero(1), 0, 1)[0], 0);
}

TEST(BoundedLeastSquares, DependentUnknownsDoNoHarm) {
  // Two equal shapes: any split of their sum is as good, and the sum is right.
  Eigen::MatrixXd a(4, 2);
  a << 1, 1, 2, 2, -1, -1, 0.5, 0.5;
  const Eigen::VectorXd b = a * Eigen::Vector2d(0.4, 0.3);
  const Eigen::VectorXd x = solveBounded(a.transpose() * a, a.transpose() * b, Eigen::Vector2d(0.0, 0.0), 0.0, 1.0);
  EXPECT_NEAR(x.sum(), 0.7, 1e-6);
}

TEST(BoundedLeastSquares, EveryUnknownHasItsOwnBounds) {
  const Problem problem = randomProblem(6, 12, 3);
  Eigen::VectorXd low(6), high(6);
  low << -0.1, 0.0, -5.0, 0.2, -1.0, -0.01;
  high << 0.1, 0.01, 5.0, 0.3, 1.0, 0.01;
  const Eigen::VectorXd x = solveBounded(problem.hessian, problem.linear, Eigen::VectorXd::Zero(6), low, high);
  const Eigen::VectorXd gradient = problem.hessian * x - problem.linear;
  int at_a_bound = 0;
  for (int i = 0; i < 6; ++i) {
    EXPECT_GE(x[i], low[i]);
    EXPECT_LE(x[i], high[i]);
    const bool at_low = x[i] == low[i], at_high = x[i] == high[i];
    at_a_bound += at_low || at_high ? 1 : 0;
    EXPECT_GT(gradient[i], at_high ? -1e9 : -1e-6);
    EXPECT_LT(gradient[i], at_low ? 1e9 : 1e-6);
  }
  EXPECT_GT(at_a_bound, 0);
}

}  // namespace
}  // namespace facezip::geometry
