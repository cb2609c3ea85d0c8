#include "facezip/geometry/shape_regression.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "facezip/error.hpp"
#include "facezip/geometry/deformation_transfer.hpp"
#include "facezip/geometry/performed_weights.hpp"

namespace facezip::geometry {
namespace {

constexpr double kConstant = 0.05;  // c: variance of the offsets' mean over people, of a shape's squared length
constexpr Eigen::Index kRegions = 24;
constexpr int kClusterRounds = 10;
constexpr Eigen::Index kTriedVertices = 1500;  // that choices are made by
constexpr std::size_t kFolds = 5;              // of subjects, left out together
// Share of an expression's strength that is taken for the performance: at first nothing is known of the shape; later
// the regression tells what of it is the person's.
constexpr double kPerformanceAtFirst = 0.3, kPerformanceLater = 0.45;
// Expressions whose squared length in a region is below this share of the longest shape's say nothing there.
constexpr double kNegligible = 1e-4;

/// The library as the regression reads it: columns 3 i + c are coordinate c of moving vertex i.
struct Data {
  std::vector<int> vertices;  ///< that some shape of the template moves, rising
  std::vector<int> region;    ///< of each of them
  Eigen::MatrixXf shapes;     ///< M by 3 #vertices
  Eigen::MatrixXd lengths;    ///< M by #vertices
  Eigen::MatrixXf displaced;  ///< S N by 3 #vertices, subject by subject
  Eigen::MatrixXd asked;      ///< N by M
  Eigen::Index subjects = 0, expressions = 0;
};

Eigen::RowVectorXf rowOf(const Eigen::MatrixX3f& displacement, const std::vector<int>& vertices) {
  Eigen::RowVectorXf row(3 * std::ssize(vertices));
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    row.segment<3>(3 * static_cast<Eigen::Index>(i)) = displacement.row(vertices[i]);
  }
  return row;
}

std::vector<int> movingVertices(const ShapeLibrary& library) {
  Eigen::VectorXd still = Eigen::VectorXd::Ones(library.neutrals[0].rows());
  for (const Eigen::MatrixX3d& shape : library.template_shapes) {
    still = still.cwiseProduct(stillVertices(library.neutrals[0], shape));
  }
  std::vector<int> moving;
  for (Eigen::Index v = 0; v < still.size(); ++v) {
    if (still[v] == 0.0) moving.push_back(static_cast<int>(v));
  }
  return moving;
}

/// Regions of skin that the same shapes move, each in the same proportions: k-means over directions, from vertices
/// evenly spread over the list.
std::vector<int> regionsOf(const Eigen::MatrixXd& lengths) {
  Eigen::MatrixXd directions = lengths;
  for (Eigen::Index v = 0; v < directions.cols(); ++v) directions.col(v).normalize();
  const Eigen::Index count = std::min(kRegions, directions.cols());
  Eigen::MatrixXd centres(directions.rows(), count);
  for (Eigen::Index k = 0; k < count; ++k) centres.col(k) = directions.col(k * directions.cols() / count);
  std::vector<int> region(static_cast<std::size_t>(directions.cols()));
  for (int round = 0; round < kClusterRounds; ++round) {
    const Eigen::VectorXd squares = centres.colwise().squaredNorm();
    Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(centres.rows(), count);
    Eigen::VectorXd members = Eigen::VectorXd::Zero(count);
    for (Eigen::Index v = 0; v < directions.cols(); ++v) {
      Eigen::Index nearest = 0;
      (2.0 * (centres.transpose() * directions.col(v)) - squares).maxCoeff(&nearest);
      region[static_cast<std::size_t>(v)] = static_cast<int>(nearest);
      sums.col(nearest) += directions.col(v);
      members[nearest] += 1.0;
    }
    for (Eigen::Index k = 0; k < count; ++k) {
      if (members[k] > 0.0) centres.col(k) = sums.col(k) / members[k];
    }
  }
  return region;
}

Data dataOf(const ShapeLibrary& library) {
  Data data;
  data.subjects = std::ssize(library.neutrals);
  data.expressions = library.asked.rows();
  data.asked = library.asked;
  data.vertices = movingVertices(library);
  const auto count = std::ssize(data.vertices);
  const auto shapes = std::ssize(library.template_shapes);
  data.shapes.resize(shapes, 3 * count);
  data.lengths.resize(shapes, count);
  for (Eigen::Index m = 0; m < shapes; ++m) {
    data.shapes.row(m) = rowOf(library.template_shapes[static_cast<std::size_t>(m)].cast<float>(), data.vertices);
    for (Eigen::Index v = 0; v < count; ++v) data.lengths(m, v) = data.shapes.row(m).segment<3>(3 * v).norm();
  }
  data.region = regionsOf(data.lengths);
  data.displaced.resize(data.subjects * data.expressions, 3 * count);
  for (Eigen::Index s = 0; s < data.subjects; ++s) {
    for (Eigen::Index e = 0; e < data.expressions; ++e) {
      const auto& example = library.examples[static_cast<std::size_t>(s)][static_cast<std::size_t>(e)];
      data.displaced.row(s * data.expressions + e) = rowOf(example, data.vertices);
    }
  }
  return data;
}

/// Further components say next to nothing, and models would be large.
constexpr Eigen::Index kMostComponents = 32;

/// What each feature counts by: the mean's, then one for each component. Products of phi are c + rho k.
Eigen::VectorXd featureWeights(const Eigen::VectorXd& deviations, const RegressionChoice& choice) {
  const Eigen::VectorXd variances = deviations.head(std::min(kMostComponents, deviations.size())).cwiseAbs2();
  Eigen::VectorXd share = variances.array() / (variances.array() + choice.softness * variances[0]);
  share *= choice.shared / share.sum();
  Eigen::VectorXd weights(1 + share.size());
  weights << std::sqrt(kConstant), share.cwiseSqrt();
  return weights;
}

/// phi of each subject, S by 1 + D.
Eigen::MatrixXd featuresOf(const Eigen::MatrixXd& scores, const Eigen::VectorXd& deviations,
                           const RegressionChoice& choice) {
  const Eigen::VectorXd weights = featureWeights(deviations, choice);
  Eigen::MatrixXd features(scores.rows(), weights.size());
  features << Eigen::VectorXd::Constant(scores.rows(), weights[0]),
      scores.leftCols(weights.size() - 1) * weights.tail(weights.size() - 1).asDiagonal();
  return features;
}

/// The joint system of one region: rows are the subjects' expressions that move it.
struct RegionSystem {
  std::vector<int> columns;            ///< moving vertices of the region that are used
  std::vector<Eigen::Index> rows;      ///< of Data::displaced
  std::vector<Eigen::Index> left_out;  ///< those of subjects that are left out
  Eigen::VectorXd squares;             ///< M: a_m^2
  Eigen::LLT<Eigen::MatrixXd> factor;
  Eigen::MatrixXf missed;  ///< rows by 3 #columns: what the template's shapes leave
};

/// What the template's shapes leave of expressions: rows by 3 #columns.
Eigen::MatrixXf missedOf(const Data& data, const Eigen::MatrixXd& weights, const std::vector<Eigen::Index>& rows,
                         const std::vector<int>& columns) {
  std::vector<Eigen::Index> flat;
  for (const int v : columns) {
    for (int c = 0; c < 3; ++c) flat.push_back(3 * v + c);
  }
  const Eigen::MatrixXf posed = weights(rows, Eigen::all).cast<float>() * data.shapes(Eigen::all, flat);
  return data.displaced(rows, flat) - posed;
}

/// used  of the subjects: the others are left out
RegionSystem systemOf(const Data& data, const Eigen::MatrixXd& weights, const Eigen::MatrixXd& features,
                      const RegressionChoice& choice, std::vector<int> columns, const std::vector<bool>& used) {
  RegionSystem system;
  system.columns = std::move(columns);
  system.squares = Eigen::VectorXd::Zero(data.lengths.rows());
  for (const int v : system.columns) system.squares += data.lengths.col(v).cwiseAbs2();
  system.squares /= static_cast<double>(system.columns.size());
  const double longest = system.squares.maxCoeff();
  const Eigen::VectorXd poses = weights.cwiseAbs2() * system.squares;  // squared lengths, shapes taken as independent
  for (Eigen::Index row = 0; row < poses.size(); ++row) {
    if (poses[row] <= kNegligible * longest) continue;
    const bool counts = used[static_cast<std::size_t>(row / data.expressions)];
    (counts ? system.rows : system.left_out).push_back(row);
  }
  const auto count = std::ssize(system.rows);
  const Eigen::MatrixXd scaled = weights(system.rows, Eigen::all) * system.squares.cwiseSqrt().asDiagonal();
  Eigen::MatrixXd covariance = scaled * scaled.transpose();
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Index s = system.rows[static_cast<std::size_t>(i)] / data.expressions;
    for (Eigen::Index j = 0; j < count; ++j) {
      const Eigen::Index t = system.rows[static_cast<std::size_t>(j)] / data.expressions;
      covariance(i, j) *= features.row(s).dot(features.row(t)) + (s == t ? 1.0 - choice.shared : 0.0);
    }
    covariance(i, i) +=
        choice.noise * choice.noise * (poses[system.rows[static_cast<std::size_t>(i)]] + 0.01 * longest);
  }
  system.factor.compute(covariance);

  system.missed = missedOf(data, weights, system.rows, system.columns);
  return system;
}

std::vector<std::vector<int>> columnsByRegion(const Data& data, Eigen::Index stride) {
  std::vector<std::vector<int>> columns(static_cast<std::size_t>(kRegions));
  for (std::size_t v = 0; v < data.region.size(); v += static_cast<std::size_t>(stride)) {
    columns[static_cast<std::size_t>(data.region[v])].push_back(static_cast<int>(v));
  }
  std::erase_if(columns, [](const auto& region) { return region.empty(); });
  return columns;
}

/// How much an expression counts when settings are chosen: every shape alike, however often it was asked for.
Eigen::VectorXd expressionWeights(const Eigen::MatrixXd& asked) {
  const Eigen::RowVectorXd times = asked.colwise().sum().cwiseMax(1e-12);
  Eigen::VectorXd weights(asked.rows());
  for (Eigen::Index e = 0; e < asked.rows(); ++e) {
    weights[e] = asked.row(e).cwiseQuotient(times).sum() / std::max(asked.row(e).sum(), 1e-12);
  }
  return weights;
}

/// Squared error of each subject's expressions predicted from the other subjects, and of the template alone.
struct LeftOut {
  double error = 0.0, nothing = 0.0, count = 0.0;
};

LeftOut leaveOut(const Data& data, const Eigen::MatrixXd& weights, const Eigen::MatrixXd& features,
                 const RegionSystem& system, const Eigen::VectorXd& counts) {
  const Eigen::MatrixXd lengths = system.squares.cwiseSqrt().asDiagonal();
  const Eigen::MatrixXd ours = weights(system.left_out, Eigen::all) * lengths;
  const Eigen::MatrixXd theirs = weights(system.rows, Eigen::all) * lengths;
  Eigen::MatrixXd covariance = ours * theirs.transpose();
  for (Eigen::Index i = 0; i < covariance.rows(); ++i) {
    const Eigen::Index s = system.left_out[static_cast<std::size_t>(i)] / data.expressions;
    for (Eigen::Index j = 0; j < covariance.cols(); ++j) {
      const Eigen::Index t = system.rows[static_cast<std::size_t>(j)] / data.expressions;
      covariance(i, j) *= features.row(s).dot(features.row(t));
    }
  }
  const Eigen::MatrixXf gain = system.factor.solve(covariance.transpose()).transpose().cast<float>();
  const Eigen::MatrixXf missed = missedOf(data, weights, system.left_out, system.columns);
  const Eigen::MatrixXf errors = missed - gain * system.missed;
  LeftOut sums;
  for (Eigen::Index i = 0; i < errors.rows(); ++i) {
    const double weight = counts[system.left_out[static_cast<std::size_t>(i)] % data.expressions];
    sums.error += weight * static_cast<double>(errors.row(i).squaredNorm());
    sums.nothing += weight * static_cast<double>(missed.row(i).squaredNorm());
    sums.count += weight * static_cast<double>(system.columns.size());
  }
  return sums;
}

/// Subjects left out together, and the components of the others' neutrals: those that are left out must not shape them.
struct Fold {
  std::vector<bool> used;
  Eigen::MatrixXd scores;  ///< S by D, of all subjects
  Eigen::VectorXd deviations;
};

std::vector<Fold> foldsOf(const std::vector<Eigen::MatrixX3d>& neutrals) {
  const std::size_t count = std::min(kFolds, neutrals.size());
  std::vector<Fold> folds(count);
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t f) {
    Fold& fold = folds[f];
    std::vector<Eigen::MatrixX3d> others;
    for (std::size_t s = 0; s < neutrals.size(); ++s) {
      fold.used.push_back(s % count != f);
      if (fold.used.back()) others.push_back(neutrals[s]);
    }
    if (others.size() < 2) others = neutrals;  // one of two subjects has no components
    const IdentityBasis basis = identityBasis(others);
    fold.deviations = basis.deviations;
    fold.scores.resize(std::ssize(neutrals), basis.size());
    for (std::size_t s = 0; s < neutrals.size(); ++s) {
      fold.scores.row(static_cast<Eigen::Index>(s)) = basis.scores(neutrals[s]).transpose();
    }
  });
  return folds;
}

/// One try of settings, on some of the vertices.
RegressionChoice tried(const Data& data, const Eigen::MatrixXd& weights, const std::vector<Fold>& folds,
                       RegressionChoice choice) {
  const Eigen::Index stride = std::max<Eigen::Index>(1, std::ssize(data.vertices) / kTriedVertices);
  const std::vector<std::vector<int>> columns = columnsByRegion(data, stride);
  const Eigen::VectorXd counts = expressionWeights(data.asked);
  std::vector<LeftOut> parts(folds.size() * columns.size());  // summed in order, whatever the number of threads
  tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t i) {
    const Fold& fold = folds[i / columns.size()];
    const Eigen::MatrixXd features = featuresOf(fold.scores, fold.deviations, choice);
    const RegionSystem system = systemOf(data, weights, features, choice, columns[i % columns.size()], fold.used);
    if (!system.rows.empty() && !system.left_out.empty()) parts[i] = leaveOut(data, weights, features, system, counts);
  });
  LeftOut sum;
  for (const LeftOut& part : parts) {
    sum = {sum.error + part.error, sum.nothing + part.nothing, sum.count + part.count};
  }
  choice.left_out = std::sqrt(sum.error / std::max(sum.count, 1e-300));
  choice.nothing = std::sqrt(sum.nothing / std::max(sum.count, 1e-300));
  return choice;
}

/// One setting after the other, each by its least error.
RegressionChoice choose(const Data& data, const Eigen::MatrixXd& weights, const std::vector<Fold>& folds,
                        const std::function<void(const char*)>& step) {
  RegressionChoice best;
  bool first = true;
  const auto attempt = [&](RegressionChoice choice) {
    if (step) step("choosing the regression");
    choice = tried(data, weights, folds, choice);
    if (first || choice.left_out < best.left_out) best = choice;
    first = false;
  };
  const auto with = [&best](double RegressionChoice::*setting, double value) {
    RegressionChoice choice = best;
    choice.*setting = value;
    return choice;
  };
  for (const double softness : {0.01, 0.1, 0.03, 0.003}) attempt(with(&RegressionChoice::softness, softness));
  for (const double shared : {0.4, 0.8}) attempt(with(&RegressionChoice::shared, shared));
  for (const double noise : {0.2, 0.12, 0.3}) attempt(with(&RegressionChoice::noise, noise));
  return best;
}

/// What each feature adds to every shape: M matrices, 1 + D by 3 #vertices, zero where the shape is still.
std::vector<Eigen::MatrixXf> regress(const Data& data, const Eigen::MatrixXd& weights, const Eigen::MatrixXd& features,
                                     const RegressionChoice& choice) {
  std::vector<Eigen::MatrixXf> slopes(static_cast<std::size_t>(data.shapes.rows()),
                                      Eigen::MatrixXf::Zero(features.cols(), data.shapes.cols()));
  const std::vector<std::vector<int>> columns = columnsByRegion(data, 1);
  const std::vector<bool> all(static_cast<std::size_t>(data.subjects), true);
  tbb::parallel_for(std::size_t{0}, columns.size(), [&](std::size_t r) {
    const RegionSystem system = systemOf(data, weights, features, choice, columns[r], all);
    std::vector<Eigen::Index> subjects;
    for (const Eigen::Index row : system.rows) subjects.push_back(row / data.expressions);
    const Eigen::MatrixXd of_rows = features(subjects, Eigen::all);
    const Eigen::MatrixXd used = weights(system.rows, Eigen::all);
    for (Eigen::Index m = 0; m < used.cols(); ++m) {
      if (system.squares[m] <= kNegligible * system.squares.maxCoeff() || used.col(m).isZero()) continue;
      // (C^-1 Phi)^T r needs fewer right-hand sides than C^-1 r.
      const Eigen::MatrixXd weighted = system.squares[m] * (used.col(m).asDiagonal() * of_rows);
      const Eigen::MatrixXf gain = system.factor.solve(weighted).transpose().cast<float>();
      const Eigen::MatrixXf found = gain * system.missed;
      for (std::size_t i = 0; i < system.columns.size(); ++i) {
        slopes[static_cast<std::size_t>(m)].middleCols<3>(3 * system.columns[i]) =
            found.middleCols<3>(3 * static_cast<Eigen::Index>(i));
      }
    }
  });
  return slopes;
}

/// The mean offset along the shape itself says how hard people tried, not how far they go: it is taken out.
void removeStrength(const Data& data, std::vector<Eigen::MatrixXf>& slopes) {
  for (std::size_t m = 0; m < slopes.size(); ++m) {
    const Eigen::RowVectorXf shape = data.shapes.row(static_cast<Eigen::Index>(m));
    const float squared = shape.squaredNorm();
    if (squared > 0.0f) slopes[m].row(0) -= (slopes[m].row(0).dot(shape) / squared) * shape;
  }
}

/// Weights of all subjects, S N by M.
Eigen::MatrixXd weightsOf(const ShapeLibrary& library, const Data& data, const std::vector<Eigen::MatrixXf>* slopes,
                          const Eigen::MatrixXd& features, const std::function<void(const char*)>& step) {
  Eigen::MatrixXd weights(data.subjects * data.expressions, data.shapes.rows());
  std::vector<Eigen::MatrixX3f> of_template;
  for (const Eigen::MatrixX3d& shape : library.template_shapes) of_template.push_back(shape.cast<float>());
  for (Eigen::Index s = 0; s < data.subjects; ++s) {
    if (step) step("weights of the performances");
    std::vector<Eigen::MatrixX3f> shapes = of_template;
    if (slopes != nullptr) {
      tbb::parallel_for(std::size_t{0}, shapes.size(), [&](std::size_t m) {
        const Eigen::RowVectorXf offset = features.row(s).cast<float>() * (*slopes)[m];
        for (std::size_t i = 0; i < data.vertices.size(); ++i) {
          shapes[m].row(data.vertices[i]) += offset.segment<3>(3 * static_cast<Eigen::Index>(i));
        }
      });
    }
    weights.middleRows(s * data.expressions, data.expressions) =
        performedWeights(shapes, library.examples[static_cast<std::size_t>(s)], data.asked,
                         slopes == nullptr ? kPerformanceAtFirst : kPerformanceLater);
  }
  return weights;
}

ShapeOffsets offsetsOf(const Data& data, Eigen::Index m, const Eigen::MatrixXf& slopes,
                       const Eigen::VectorXd& per_feature, const Eigen::MatrixX3d& neutral) {
  ShapeOffsets offsets;
  const double still = 1e-5 * boundingDiagonal(neutral);
  std::vector<Eigen::Index> flat;
  for (std::size_t i = 0; i < data.vertices.size(); ++i) {
    const auto v = static_cast<Eigen::Index>(i);
    if (data.lengths(m, v) <= still) continue;
    offsets.vertices.push_back(data.vertices[i]);
    for (int c = 0; c < 3; ++c) flat.push_back(3 * v + c);
  }
  offsets.rows = per_feature.cast<float>().asDiagonal() * slopes(Eigen::all, flat);
  return offsets;
}

void requireConsistent(const ShapeLibrary& library) {
  const auto require = [](bool holds, const char* item, const std::string& expected, const std::string& got) {
    if (!holds) throw InputError({"", item, expected, got, ""});
  };
  require(library.neutrals.size() >= 2, "library", "at least two subjects", fmt::format("{}", library.neutrals.size()));
  require(library.examples.size() == library.neutrals.size(), "library", "expressions of every subject", "of others");
  require(library.asked.cols() == std::ssize(library.template_shapes), "asked weights",
          fmt::format("{} shapes", library.template_shapes.size()), fmt::format("{}", library.asked.cols()));
  for (const auto& examples : library.examples) {
    require(std::ssize(examples) == library.asked.rows(), "library",
            fmt::format("{} expressions", library.asked.rows()), fmt::format("{}", examples.size()));
  }
  require(library.asked.maxCoeff() > 0.0, "asked weights", "some above 0", "none");
}

}  // namespace

std::vector<Eigen::MatrixX3d> ShapeRegression::predict(const Eigen::MatrixX3d& neutral, double most) const {
  Eigen::RowVectorXf features(1 + identity.size());
  features << 1.0f, identity.scores(neutral).cwiseMax(-most).cwiseMin(most).transpose().cast<float>();
  std::vector<Eigen::MatrixX3d> predicted;
  for (const ShapeOffsets& shape : offsets) {
    Eigen::MatrixX3d displacement = Eigen::MatrixX3d::Zero(neutral.rows(), 3);
    const Eigen::RowVectorXf flat = features * shape.rows;
    for (std::size_t i = 0; i < shape.vertices.size(); ++i) {
      displacement.row(shape.vertices[i]) = flat.segment<3>(3 * static_cast<Eigen::Index>(i)).cast<double>();
    }
    predicted.push_back(std::move(displacement));
  }
  return predicted;
}

ShapeRegression learnShapes(const ShapeLibrary& library, const RegressionOptions& options,
                            const std::function<void(const char*)>& step) {
  requireConsistent(library);
  const IdentityBasis identity = identityBasis(library.neutrals);
  if (identity.size() == 0) {
    throw InputError({"", "library", "neutrals that differ", "the same of all subjects", ""});
  }
  const Data data = dataOf(library);
  Eigen::MatrixXd scores(data.subjects, identity.size());
  for (Eigen::Index s = 0; s < data.subjects; ++s) {
    scores.row(s) = identity.scores(library.neutrals[static_cast<std::size_t>(s)]).transpose();
  }
  Eigen::MatrixXd weights = weightsOf(library, data, nullptr, {}, step);
  const std::vector<Fold> folds = foldsOf(library.neutrals);
  RegressionChoice choice;
  Eigen::MatrixXd features;
  std::vector<Eigen::MatrixXf> slopes;
  for (int round = 0; round < options.rounds; ++round) {
    if (round > 0) weights = weightsOf(library, data, &slopes, features, step);
    // Settings matter little while weights are rough, and trying them is what takes the time.
    if (round + 1 == options.rounds) choice = choose(data, weights, folds, step);
    choice.components = static_cast<int>(std::min(kMostComponents, identity.size()));
    features = featuresOf(scores, identity.deviations, choice);
    if (step) step("regressing the shapes");
    slopes = regress(data, weights, features, choice);
    removeStrength(data, slopes);
  }
  ShapeRegression regression;
  regression.identity = leading(identity, choice.components);
  regression.choice = choice;
  regression.weights = std::move(weights);
  const Eigen::VectorXd per_feature = featureWeights(identity.deviations, choice);
  for (std::size_t m = 0; m < slopes.size(); ++m) {
    regression.offsets.push_back(
        offsetsOf(data, static_cast<Eigen::Index>(m), slopes[m], per_feature, library.neutrals[0]));
  }
  return regression;
}

}  // namespace facezip::geometry
