#include "facezip/geometry/mask_weights.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "facezip/error.hpp"
#include "facezip/geometry/laplacian.hpp"

namespace facezip::geometry {
namespace {

constexpr const char* kStep = "mask weights";

// For each region vertex its place among the samples, or -1. Refuses samples that cannot fix the system.
std::vector<int> samplePlaces(const RegionMesh& region, std::span<const int> samples) {
  std::vector<int> places(static_cast<std::size_t>(region.vertexCount()), -1);
  std::vector<bool> has_sample(static_cast<std::size_t>(region.component_count), false);
  for (std::size_t k = 0; k < samples.size(); ++k) {
    const int vertex = samples[k];
    if (vertex < 0 || vertex >= region.vertexCount() || places[static_cast<std::size_t>(vertex)] >= 0) {
      throw InputError({"", fmt::format("mask sample {}", k),
                        fmt::format("distinct region vertices from 0 to {}", region.vertexCount() - 1),
                        std::to_string(vertex), ""});
    }
    places[static_cast<std::size_t>(vertex)] = static_cast<int>(k);
    has_sample[static_cast<std::size_t>(region.components[static_cast<std::size_t>(vertex)])] = true;
  }
  const auto missing = std::find(has_sample.begin(), has_sample.end(), false);
  if (missing != has_sample.end()) {
    throw InputError({"", fmt::format("component {} of the face region", missing - has_sample.begin()),
                      "at least one mask sample", "none", ""});
  }
  return places;
}

// Entries of one row that stay, and what went.
struct CutRow {
  std::vector<std::pair<int, double>> kept;  // mask, weight clamped to [0,1]
  double kept_sum = 0;
  double clamped_sum = 0;
  double overshoot = 0;
  int active_before = 0;
};

CutRow cutRow(const Eigen::RowVectorXd& row, double cutoff) {
  CutRow cut;
  Eigen::Index strongest = 0;
  row.maxCoeff(&strongest);
  for (Eigen::Index k = 0; k < row.size(); ++k) {
    const double clamped = std::clamp(row[k], 0.0, 1.0);
    cut.overshoot = std::max(cut.overshoot, std::abs(row[k] - clamped));
    cut.clamped_sum += clamped;
    if (clamped == 0) continue;
    ++cut.active_before;
    if (clamped < cutoff && k != strongest) continue;
    cut.kept.emplace_back(static_cast<int>(k), clamped);
    cut.kept_sum += clamped;
  }
  return cut;
}

// Divides the kept weights by their sum and appends them as the next row.
void appendRow(const CutRow& cut, MaskWeights& masks) {
  for (const auto& [mask, weight] : cut.kept) {
    masks.mask_index.push_back(mask);
    masks.weight.push_back(static_cast<float>(weight / cut.kept_sum));
  }
  masks.row_begin.push_back(static_cast<int>(masks.mask_index.size()));
}

// Adds a row to the maxima, and with its share to the means.
void addCost(const CutRow& cut, double share, MaskCutCost& cost) {
  const double removed = 1 - cut.kept_sum / cut.clamped_sum;
  cost.largest_removed = std::max(cost.largest_removed, removed);
  cost.mean_removed += share * removed;
  cost.largest_overshoot = std::max(cost.largest_overshoot, cut.overshoot);
  cost.mean_active_before += share * cut.active_before;
  cost.mean_active_after += share * static_cast<double>(cut.kept.size());
}

double largestRowSum(const Eigen::SparseMatrix<double>& symmetric) {
  double largest = 0;
  for (Eigen::Index column = 0; column < symmetric.cols(); ++column) {
    largest = std::max(largest, symmetric.col(column).cwiseAbs().sum());
  }
  return largest;
}

}  // namespace

BiharmonicSolver::BiharmonicSolver(const RegionMesh& region, std::span<const int> samples)
    : samples_(samples.begin(), samples.end()) {
  const std::vector<int> places = samplePlaces(region, samples);
  std::vector<int> free_places(places.size(), -1);
  for (int v = 0; v < region.vertexCount(); ++v) {
    if (places[static_cast<std::size_t>(v)] >= 0) continue;
    free_places[static_cast<std::size_t>(v)] = static_cast<int>(free_.size());
    free_.push_back(v);
  }

  // Minimising |L phi|^2 over the free values: (L^T L)_ff phi_f = -(L^T L)_fs phi_s.
  const Eigen::SparseMatrix<double> laplacian = combinatorialLaplacian(region);
  const Eigen::SparseMatrix<double> bilaplacian = laplacian.transpose() * laplacian;
  std::vector<Eigen::Triplet<double>> free_entries;
  std::vector<Eigen::Triplet<double>> fixed_entries;
  for (int column = 0; column < bilaplacian.outerSize(); ++column) {
    const auto c = static_cast<std::size_t>(column);
    for (Eigen::SparseMatrix<double>::InnerIterator entry(bilaplacian, column); entry; ++entry) {
      const int row = free_places[static_cast<std::size_t>(entry.row())];
      if (row < 0) continue;
      if (free_places[c] >= 0) free_entries.emplace_back(row, free_places[c], entry.value());
      if (places[c] >= 0) fixed_entries.emplace_back(row, places[c], entry.value());
    }
  }
  const auto free_count = static_cast<Eigen::Index>(free_.size());
  free_free_.resize(free_count, free_count);
  free_free_.setFromTriplets(free_entries.begin(), free_entries.end());
  free_fixed_.resize(free_count, static_cast<Eigen::Index>(samples_.size()));
  free_fixed_.setFromTriplets(fixed_entries.begin(), fixed_entries.end());
  factor();
}

void BiharmonicSolver::factor() {
  if (free_.empty()) return;  // every vertex is a sample
  matrix_norm_ = largestRowSum(free_free_);
  factorisation_.compute(free_free_);
  // A pivot that is not positive: the matrix was not definite, whatever the factorisation says.
  if (factorisation_.info() != Eigen::Success || !(factorisation_.vectorD().minCoeff() > 0)) {
    throw SolverError(kStep, freeCount(), std::numeric_limits<double>::quiet_NaN());
  }
}

double BiharmonicSolver::residualOf(const Eigen::VectorXd& rhs, const Eigen::VectorXd& solution) const {
  const double scale = matrix_norm_ * solution.lpNorm<Eigen::Infinity>() + rhs.lpNorm<Eigen::Infinity>();
  if (scale == 0) return 0;
  return (rhs - free_free_ * solution).lpNorm<Eigen::Infinity>() / scale;
}

double BiharmonicSolver::residual(const Eigen::MatrixXd& phi) const {
  double largest = 0;
  for (const auto& column : phi.colwise()) {
    const Eigen::VectorXd rhs = -(free_fixed_ * column(samples_));
    largest = std::max(largest, residualOf(rhs, column(free_)));
  }
  return largest;
}

Eigen::VectorXd BiharmonicSolver::solveColumn(const Eigen::VectorXd& rhs) const {
  Eigen::VectorXd solution = factorisation_.solve(rhs);
  if (residualOf(rhs, solution) <= kResidualBound) return solution;
  // One step of iterative refinement.
  solution += factorisation_.solve(rhs - free_free_ * solution);
  const double residual = residualOf(rhs, solution);
  if (!(residual <= kResidualBound)) throw SolverError(kStep, freeCount(), residual);  // NaN too
  return solution;
}

Eigen::MatrixXd BiharmonicSolver::solve(const Eigen::MatrixXd& values) const {
  const auto sample_count = static_cast<Eigen::Index>(samples_.size());
  if (values.rows() != sample_count) {
    throw InputError(
        {"", "values at the mask samples", fmt::format("{} rows", sample_count), std::to_string(values.rows()), ""});
  }
  Eigen::MatrixXd phi(freeCount() + sample_count, values.cols());
  phi(samples_, Eigen::all) = values;
  if (free_.empty()) return phi;
  for (Eigen::Index column = 0; column < values.cols(); ++column) {
    phi(free_, column) = solveColumn(-(free_fixed_ * values.col(column)));
  }
  return phi;
}

Eigen::MatrixXd solveMaskWeights(const RegionMesh& region, std::span<const int> samples) {
  const auto count = static_cast<Eigen::Index>(samples.size());
  return BiharmonicSolver(region, samples).solve(Eigen::MatrixXd::Identity(count, count));
}

MaskWeights compactMaskWeights(const Eigen::MatrixXd& phi, double cutoff) {
  if (!(cutoff >= 0 && cutoff < 1)) {
    throw InputError({"", "mask cutoff", "a number from 0 to below 1", fmt::format("{}", cutoff), ""});
  }
  MaskWeights masks;
  masks.mask_count = static_cast<int>(phi.cols());
  masks.row_begin.push_back(0);
  const double share = 1.0 / static_cast<double>(std::max<Eigen::Index>(phi.rows(), 1));
  for (Eigen::Index v = 0; v < phi.rows(); ++v) {
    const Eigen::RowVectorXd row = phi.row(v);
    const CutRow cut = row.size() > 0 && row.allFinite() ? cutRow(row, cutoff) : CutRow{};
    if (cut.kept.empty()) {
      throw InputError({"", fmt::format("mask weights of vertex {}", v), "a positive one, all finite", "none", ""});
    }
    appendRow(cut, masks);
    addCost(cut, share, masks.cost);
  }
  return masks;
}

}  // namespace facezip::geometry
