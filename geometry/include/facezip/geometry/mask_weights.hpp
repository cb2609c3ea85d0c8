// mask_weights.hpp - smooth masks around the samples of the face region (FaceZip 3.1, Mask Computation).
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <span>
#include <vector>

#include "facezip/geometry/face_region.hpp"

namespace facezip::geometry {

/// Interpolates values given at K sample vertices as smoothly as the mesh allows: minimises |L phi|^2, L the
/// combinatorial Laplacian, with phi fixed at the samples. Factors the system once; solves for any number of right-hand
/// sides. Values of one connected component never reach another: the system is block-diagonal.
class BiharmonicSolver {
 public:
  /// Largest accepted |b - A x| / (|A| |x| + |b|), in maximum norms, of each column. LDL^T of the systems at
  /// hand leaves 1e-16 to 1e-15; a thousand times that is a sign of a broken matrix, not of rounding.
  static constexpr double kResidualBound = 1e-12;

  /// samples  K >= 1 distinct region vertices, at least one in every component
  /// Throws InputError naming the vertex or component; SolverError if the factorisation fails.
  BiharmonicSolver(const RegionMesh& region, std::span<const int> samples);

  /// Returns #V by C, fixed rows included: row samples[k] is row k of the values.
  /// values  K by C, one right-hand side a column
  /// Throws SolverError with the residual if a column, refined once, misses kResidualBound.
  Eigen::MatrixXd solve(const Eigen::MatrixXd& values) const;

  /// Largest residual of the columns of phi, #V by C, as kResidualBound measures it.
  double residual(const Eigen::MatrixXd& phi) const;

  /// Number of unknowns: vertices that are no samples.
  int freeCount() const { return static_cast<int>(free_.size()); }

 private:
  void factor();
  Eigen::VectorXd solveColumn(const Eigen::VectorXd& rhs) const;
  double residualOf(const Eigen::VectorXd& rhs, const Eigen::VectorXd& solution) const;

  std::vector<int> samples_;                // K, region vertices whose values are given
  std::vector<int> free_;                   // the others, ascending
  Eigen::SparseMatrix<double> free_free_;   // rows and columns of L^T L at free vertices
  Eigen::SparseMatrix<double> free_fixed_;  // rows at free vertices, columns at samples
  double matrix_norm_ = 0;                  // maximum absolute row sum of free_free_
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factorisation_;
};

/// Solves the K masks at the vertices: phi_k minimises |L phi_k|^2 with phi_k = 1 at samples[k] and 0 at other samples.
/// Returns #V by K. Rows sum to 1 to rounding. Values overshoot [0,1], at open boundaries by half and more.
/// samples and errors  as for BiharmonicSolver
Eigen::MatrixXd solveMaskWeights(const RegionMesh& region, std::span<const int> samples);

/// Smallest weight that a mask keeps, see compactMaskWeights. Measured on the ICT face region (9,409 vertices, 64
/// samples 3 cm apart); uncut, a vertex has 32.1 masks, a mask covers 50 % of the vertices and all 2,016 pairs of masks
/// overlap:
///     cutoff   masks a vertex   a mask covers   pairs that overlap   share cut, mean   largest
///     0.001         14.1             22 %              1,830              0.2 %          0.8 %
///     0.01           6.6             10 %                975              2.3 %          6.1 %
///     0.05           3.5              5 %                343              6.8 %         21.9 %
/// At 0.01 masks have become local: half of the pairs need no seam table, a vertex a fifth of the memory. A mask ends
/// in a ramp of at most 2.6 of 255 levels over one triangle; at 0.05 it would be 13 levels, which show as seams.
inline constexpr double kDefaultMaskCutoff = 0.01;

/// What clamping and cutting tails did to the masks.
struct MaskCutCost {
  double largest_removed = 0;     ///< largest share, 0..1, of a vertex's clamped weights that fell below the cutoff
  double mean_removed = 0;        ///< mean over the vertices of that share
  double largest_overshoot = 0;   ///< how far phi went above 1 or below 0 before clamping
  double mean_active_before = 0;  ///< mean number of masks above zero at a vertex
  double mean_active_after = 0;   ///< mean number of masks kept at a vertex
};

/// Masks with compact support, by rows: the masks of vertex v are entries row_begin[v] .. row_begin[v + 1] - 1.
struct MaskWeights {
  int mask_count = 0;           ///< K
  std::vector<int> row_begin;   ///< #V + 1, from 0 to the number of entries
  std::vector<int> mask_index;  ///< per entry: mask, ascending in a row
  std::vector<float> weight;    ///< per entry: in (0,1]; the weights of a row sum to 1 to float rounding
  MaskCutCost cost;

  int vertexCount() const { return static_cast<int>(row_begin.size()) - 1; }
};

/// Clamps to [0,1], drops entries below the cutoff (never a row's largest), and divides each row by its sum, as in
/// M_k = phi_k / sum phi (FaceZip 3.1). The paper cuts nothing; but biharmonic masks ripple over the whole face,
/// and without a cut every texel carries every mask.
/// phi     #V by K, from solveMaskWeights
/// cutoff  in [0, 1)
/// Throws InputError for any other cutoff, or a row without a positive finite entry.
MaskWeights compactMaskWeights(const Eigen::MatrixXd& phi, double cutoff = kDefaultMaskCutoff);

}  // namespace facezip::geometry
