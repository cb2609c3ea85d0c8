// block_rank_energy.hpp - what the best C components of every block of texels would leave, for all C at once.
//   E_C = sum over blocks of sum over j > C of s_j^2,  s_1 >= s_2 >= ... the singular values of the block's differences
// A block of s x s texels that has weights of its own, C of them an expression, and C difference textures is a matrix
// of rank C (Eckart and Young 1936). Weight maps are interpolated between cells, so a package is not bound by it in the
// strict sense: it is the size of error that C textures and weights at 1/s of the resolution allow.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "bands/tile_band.hpp"

namespace facezip::compress {

/// Residual energy of one block size.
struct RankEnergy {
  static constexpr int kMostComponents = 8;
  /// [C], C = 0 to 8: squared error that the best C components of each block leave, in (1/255)^2. [0] is the energy of
  /// the differences.
  std::array<double, kMostComponents + 1> residual{};
  std::uint64_t texels = 0;  ///< covered ones that were looked at
};

/// Gram matrices of the smallest blocks, added up over maps that share weights, each times its weight: what C textures
/// for all of them can leave is more than what each would leave alone. In single precision.
class SharedGrams {
 public:
  SharedGrams(std::size_t blocks, int expressions) : grams_(blocks), expressions_(expressions) {}

  /// Blocks of their own may be added to by several threads.
  void add(std::size_t block, const Eigen::MatrixXd& gram, double weight);
  /// Empty where nothing was added.
  Eigen::MatrixXd gram(std::size_t block) const;

  /// Bytes of the Gram matrix of one block.
  static std::size_t bytes(int expressions);

 private:
  std::vector<std::vector<float>> grams_;  ///< [block][lower triangle]
  int expressions_;
};

/// Adds up the residual energies of blocks of several sizes in one pass over a map, band by band. Gram matrices of
/// small blocks add up to those of the large blocks that hold them, so each size costs its eigenvalues alone. Sums are
/// in double; texels of a block in their order, blocks in theirs: the same bits on any number of threads. Memory: one
/// row of blocks of each size, at most N x N doubles a block.
class BlockRankEnergy {
 public:
  /// sides        of the blocks in texels, rising, each a multiple of the one before; the grid begins at texel (0, 0)
  /// width, height, channels, expressions   of the map
  /// stride       looks at one in so many blocks of the largest size (and all that it holds), odd; 1: at all
  BlockRankEnergy(std::vector<int> sides, int width, int height, int channels, int expressions, int stride = 1);

  /// Adds rows [begin_row, begin_row + shape.rows): bands come in rising order and leave no row out.
  /// samples  neutral, then expressions, as a MapBand has them
  /// texels   the covered ones, as coveredTexels() gives them
  void addBand(int begin_row, std::span<const std::byte> samples, const BandShape& shape,
               std::span<const std::uint32_t> texels);

  /// Adds the smallest blocks' Gram matrices, times `weight`, to `grams` from now on too: index y * across + x.
  void shareWith(SharedGrams& grams, double weight);

  /// The energies of the blocks of `grams`, of the same sizes as this object's. Texels are not counted.
  std::vector<RankEnergy> energiesOf(const SharedGrams& grams) const;

  /// Number of the smallest blocks.
  std::size_t smallestBlocks() const;

  /// One per side, when all rows were added.
  const std::vector<RankEnergy>& energies() const { return energies_; }

 private:
  /// What is known so far of a block.
  struct Block {
    Eigen::MatrixXd gram;        ///< N x N; empty when no texel is covered
    std::vector<float> samples;  ///< instead, in blocks of fewer samples than expressions: samples x N
    std::uint64_t texels = 0;
  };
  struct Level {
    int side = 0;
    int row = 0;                ///< of blocks
    std::vector<Block> blocks;  ///< of that row
  };

  bool keepsSamples() const;
  bool isSampled(int block_x, int block_y) const;
  void addRows(int begin_row, int band_row, int end_row, std::span<const std::byte> samples, const BandShape& shape,
               const std::vector<std::uint8_t>& covered);
  void addDifferences(Block& block, const Eigen::MatrixXf& differences) const;
  void closeRow(std::size_t level);
  void foldInto(Level& larger, const Level& smaller) const;

  int width_;
  int height_;
  int channels_;
  int expressions_;
  int stride_;
  std::vector<Level> levels_;
  std::vector<RankEnergy> energies_;
  SharedGrams* shared_ = nullptr;
  double shared_weight_ = 0.0;
};

}  // namespace facezip::compress
