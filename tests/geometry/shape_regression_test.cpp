#include "facezip/geometry/shape_regression.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "facezip/error.hpp"
#include "facezip/geometry/performed_weights.hpp"

namespace facezip::geometry {
namespace {

constexpr int kSide = 12;
constexpr int kVertices = kSide * kSide;

/// A bump of the patch: out of it on the left or on the right half.
Eigen::MatrixX3d bump(bool right, double x_share, double z_share) {
  Eigen::MatrixX3d moved = Eigen::MatrixX3d::Zero(kVertices, 3);
  for (int v = 0; v < kVertices; ++v) {
    const double x = static_cast<double>(v % kSide) / (kSide - 1), y = static_cast<double>(v / kSide) / (kSide - 1);
    const double r = std::hypot(x - (right ? 0.75 : 0.25), y - 0.5) / 0.24;
    if (r < 1) moved.row(v) << x_share * (1 - r), 0.0, z_share * (1 - r);
  }
  return moved;
}

/// People whose heads differ in two ways: one says how far the left bump goes, the other which way the right one does.
struct Person {
  Eigen::MatrixX3d neutral;
  std::vector<Eigen::MatrixX3d> shapes;
};

Person personOf(double wide, double deep) {
  Person person;
  person.neutral = Eigen::MatrixX3d::Zero(kVertices, 3);
  for (int v = 0; v < kVertices; ++v) {
    const double x = static_cast<double>(v % kSide) / (kSide - 1), y = static_cast<double>(v / kSide) / (kSide - 1);
    person.neutral.row(v) << 10 * x * (1 + 0.1 * wide), 10 * y, deep * x * y;
  }
  person.shapes = {bump(false, 0.0, 1.0) * (1 + 0.25 * wide), bump(true, 0.3 * deep, 1.0)};
  return person;
}

/// Every person smiles left, right, and with both; asked for whole shapes, and performed with a little less.
ShapeLibrary libraryOf(int subjects) {
  ShapeLibrary library;
  library.template_shapes = {bump(false, 0.0, 1.0), bump(true, 0.0, 1.0)};
  library.asked.resize(3, 2);
  library.asked << 1, 0, 0, 1, 1, 1;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> between(-1.7, 1.7), effort(0.9, 1.0);
  for (int s = 0; s < subjects; ++s) {
    const Person person = personOf(between(random), between(random));
    library.neutrals.push_back(person.neutral);
    library.examples.emplace_back();
    for (int e = 0; e < 3; ++e) {
      Eigen::MatrixX3d moved = Eigen::MatrixX3d::Zero(kVertices, 3);
      for (int m = 0; m < 2; ++m) {
        moved += effort(random) * library.asked(e, m) * person.shapes[static_cast<std::size_t>(m)];
      }
      library.examples.back().push_back(moved.cast<float>());
    }
  }
  return library;
}

double distance(const std::vector<Eigen::MatrixX3d>& shapes, const std::vector<Eigen::MatrixX3d>& truth) {
  double sum = 0.0;
  for (std::size_t m = 0; m < truth.size(); ++m) sum += (shapes[m] - truth[m]).squaredNorm();
  return std::sqrt(sum);
}

TEST(ShapeRegression, TellsTheShapesOfAStrangerFromTheNeutral) {
  const ShapeLibrary library = libraryOf(24);
  const ShapeRegression learned = learnShapes(library, {2});
  double template_error = 0.0, error = 0.0;
  for (const auto& [wide, deep] : {std::pair{1.2, -0.8}, {-1.0, 1.0}, {0.5, 1.4}, {-1.3, -1.2}}) {
    const Person stranger = personOf(wide, deep);
    std::vector<Eigen::MatrixX3d> shapes = learned.predict(stranger.neutral, 3.0);
    for (std::size_t m = 0; m < 2; ++m) shapes[m] += library.template_shapes[m];
    error += distance(shapes, stranger.shapes);
    template_error += distance(library.template_shapes, stranger.shapes);
  }
  EXPECT_LT(error, 0.4 * template_error);
  EXPECT_LT(learned.choice.left_out, 0.6 * learned.choice.nothing);
}

TEST(ShapeRegression, LeavesStillWhatTheTemplateDoesNotMove) {
  const ShapeRegression learned = learnShapes(libraryOf(8), {1});
  const std::vector<Eigen::MatrixX3d> offsets = learned.predict(personOf(1.0, 1.0).neutral, 3.0);
  for (int v = 0; v < kVertices; ++v) {
    if (bump(false, 0.0, 1.0).row(v).isZero(0.0)) {
      EXPECT_TRUE(offsets[0].row(v).isZero(0.0)) << v;
    }
  }
}

TEST(ShapeRegression, HowHardPeopleTryIsNoShape) {
  // Everybody is the template and does seven tenths of what is asked: shapes stay as long as the template's.
  ShapeLibrary library = libraryOf(6);
  for (auto& examples : library.examples) {
    for (int e = 0; e < 3; ++e) {
      Eigen::MatrixX3d moved = Eigen::MatrixX3d::Zero(kVertices, 3);
      for (int m = 0; m < 2; ++m)
        moved += 0.7 * library.asked(e, m) * library.template_shapes[static_cast<std::size_t>(m)];
      examples[static_cast<std::size_t>(e)] = moved.cast<float>();
    }
  }
  const ShapeRegression learned = learnShapes(library, {2});
  const std::vector<Eigen::MatrixX3d> offsets = learned.predict(learned.identity.mean, 3.0);
  EXPECT_LT(offsets[0].norm() + offsets[1].norm(), 0.02 * library.template_shapes[0].norm());
}

TEST(ShapeRegression, IsTheSameAgain) {
  const ShapeRegression one = learnShapes(libraryOf(6), {2}), other = learnShapes(libraryOf(6), {2});
  for (std::size_t m = 0; m < 2; ++m) EXPECT_EQ(one.offsets[m].rows, other.offsets[m].rows);
}

TEST(ShapeRegression, RefusesWhatSaysNothing) {
  ShapeLibrary library = libraryOf(3);
  library.neutrals.resize(1);
  library.examples.resize(1);
  EXPECT_THROW(learnShapes(library, {1}), InputError);
  library = libraryOf(3);
  library.neutrals[1] = library.neutrals[2] = library.neutrals[0];
  EXPECT_THROW(learnShapes(library, {1}), InputError);
  library = libraryOf(3);
  library.asked.setZero();
  EXPECT_THROW(learnShapes(library, {1}), InputError);
}

TEST(PerformedWeights, TellWhatWasNotAskedAndLeaveStrengthToTheShape) {
  const std::vector<Eigen::MatrixX3f> shapes = {bump(false, 0.0, 1.0).cast<float>(),
                                                bump(true, 0.0, 1.0).cast<float>()};
  const std::vector<Eigen::MatrixX3f> examples = {1.2f * shapes[0] + 0.2f * shapes[1]};
  Eigen::MatrixXd asked(1, 2);
  asked << 1, 0;
  const Eigen::MatrixXd weights = performedWeights(shapes, examples, asked, 0.25);
  EXPECT_NEAR(weights(0, 0), 1.05, 1e-3);
  EXPECT_NEAR(weights(0, 1), 0.2, 0.02);
}

TEST(IdentityBasis, ScoresHaveUnitVarianceAndPoseTheSubjects) {
  const ShapeLibrary library = libraryOf(9);
  const IdentityBasis basis = identityBasis(library.neutrals);
  ASSERT_EQ(basis.size(), 2);  // people differ in two ways
  Eigen::VectorXd squares = Eigen::VectorXd::Zero(2);
  for (const Eigen::MatrixX3d& neutral : library.neutrals) squares += basis.scores(neutral).cwiseAbs2();
  EXPECT_NEAR(squares[0] / 9, 1.0, 1e-9);
  EXPECT_NEAR(squares[1] / 9, 1.0, 1e-9);
  EXPECT_GE(basis.deviations[0], basis.deviations[1]);
}

}  // namespace
}  // namespace facezip::geometry
