#include "rate/block_rank_energy.hpp"

#include <tbb/parallel_for.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cassert>

#include "bands/band_differences.hpp"

namespace facezip::compress {
namespace {

using Residual = std::array<double, RankEnergy::kMostComponents + 1>;

/// Residuals of a block from its Gram matrix, of either side: the non-zero eigenvalues are the same.
Residual residualsOf(const Eigen::MatrixXd& gram) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(gram, Eigen::EigenvaluesOnly);  // ascending
  Residual residual{};
  for (int c = 0; c <= RankEnergy::kMostComponents && c < gram.rows(); ++c) {
    const double sum = solver.eigenvalues().head(gram.rows() - c).sum();
    residual[static_cast<std::size_t>(c)] = std::max(0.0, sum);  // rounding may pass below zero
  }
  return residual;
}

/// The covered texels of a rectangle of the band, as gatherDifferences() takes them.
std::vector<std::uint32_t> coveredInside(const std::vector<std::uint8_t>& covered, int width, int x_begin, int x_end,
                                         int y_begin, int y_end) {
  std::vector<std::uint32_t> inside;
  for (int y = y_begin; y < y_end; ++y) {
    const std::uint32_t row = static_cast<std::uint32_t>(y) * static_cast<std::uint32_t>(width);
    for (int x = x_begin; x < x_end; ++x) {
      if (covered[row + static_cast<std::uint32_t>(x)] != 0) inside.push_back(row + static_cast<std::uint32_t>(x));
    }
  }
  return inside;
}

int blocksAcross(int texels, int side) { return (texels + side - 1) / side; }

}  // namespace

std::size_t SharedGrams::bytes(int expressions) {
  const auto n = static_cast<std::size_t>(expressions);
  return n * (n + 1) / 2 * sizeof(float);
}

void SharedGrams::add(std::size_t block, const Eigen::MatrixXd& gram, double weight) {
  std::vector<float>& sum = grams_[block];
  sum.resize(bytes(expressions_) / sizeof(float), 0.0f);
  std::size_t entry = 0;
  for (Eigen::Index n = 0; n < gram.cols(); ++n) {
    for (Eigen::Index m = n; m < gram.rows(); ++m) sum[entry++] += static_cast<float>(weight * gram(m, n));
  }
}

Eigen::MatrixXd SharedGrams::gram(std::size_t block) const {
  if (grams_[block].empty()) return {};
  Eigen::MatrixXd gram(expressions_, expressions_);
  std::size_t entry = 0;
  for (Eigen::Index n = 0; n < gram.cols(); ++n) {
    for (Eigen::Index m = n; m < gram.rows(); ++m)
      gram(m, n) = gram(n, m) = static_cast<double>(grams_[block][entry++]);
  }
  return gram;
}

BlockRankEnergy::BlockRankEnergy(std::vector<int> sides, int width, int height, int channels, int expressions,
                                 int stride)
    : width_(width), height_(height), channels_(channels), expressions_(expressions), stride_(stride) {
  assert(!sides.empty() && stride >= 1);
  for (const int side : sides) {
    assert(side >= 1 && (levels_.empty() || side % levels_.back().side == 0));
    levels_.push_back({side, 0, std::vector<Block>(static_cast<std::size_t>(blocksAcross(width, side)))});
  }
  energies_.resize(levels_.size());
}

// Fewer samples than expressions: the matrix is smaller the other way round, and so are its eigenvalues' costs. Larger
// blocks could not be made of it.
bool BlockRankEnergy::keepsSamples() const {
  const int side = levels_.front().side;
  return levels_.size() == 1 && static_cast<long>(side) * side * channels_ < expressions_;
}

bool BlockRankEnergy::isSampled(int block_x, int block_y) const {
  const int side = levels_.front().side;
  const int largest = levels_.back().side;
  const long x = static_cast<long>(block_x) * side / largest;
  const long y = static_cast<long>(block_y) * side / largest;
  return (x + 2 * y) % stride_ == 0;  // slanted: columns of blocks would be alike in what they see
}

void BlockRankEnergy::addDifferences(Block& block, const Eigen::MatrixXf& differences) const {
  block.texels += static_cast<std::uint64_t>(differences.rows() / channels_);
  if (keepsSamples()) {
    for (Eigen::Index row = 0; row < differences.rows(); ++row) {
      for (Eigen::Index n = 0; n < differences.cols(); ++n) block.samples.push_back(differences(row, n));
    }
    return;
  }
  if (block.gram.size() == 0) block.gram = Eigen::MatrixXd::Zero(expressions_, expressions_);
  const Eigen::MatrixXd exact = differences.cast<double>();
  block.gram.noalias() += exact.transpose() * exact;
}

// Rows [band_row, end_row) of the band, which lie in one row of the smallest blocks.
void BlockRankEnergy::addRows(int begin_row, int band_row, int end_row, std::span<const std::byte> samples,
                              const BandShape& shape, const std::vector<std::uint8_t>& covered) {
  Level& level = levels_.front();
  tbb::parallel_for(std::size_t{0}, level.blocks.size(), [&](std::size_t b) {
    const int block_x = static_cast<int>(b);
    if (!isSampled(block_x, (begin_row + band_row) / level.side)) return;
    const int x_begin = block_x * level.side;
    const int x_end = std::min(width_, x_begin + level.side);
    const auto inside = coveredInside(covered, width_, x_begin, x_end, band_row, end_row);
    if (!inside.empty()) addDifferences(level.blocks[b], gatherDifferences(samples, shape, inside));
  });
}

void BlockRankEnergy::addBand(int begin_row, std::span<const std::byte> samples, const BandShape& shape,
                              std::span<const std::uint32_t> texels) {
  assert(shape.width == width_ && shape.channels == channels_ && shape.expressions == expressions_);
  std::vector<std::uint8_t> covered(static_cast<std::size_t>(shape.rows) * static_cast<std::size_t>(shape.width), 0);
  for (const std::uint32_t texel : texels) covered[texel] = 1;
  const int side = levels_.front().side;
  for (int row = 0; row < shape.rows;) {
    const int end_of_blocks = ((begin_row + row) / side + 1) * side - begin_row;
    const int end = std::min(shape.rows, end_of_blocks);
    addRows(begin_row, row, end, samples, shape, covered);
    if (end == end_of_blocks || begin_row + end == height_) closeRow(0);
    row = end;
  }
}

void BlockRankEnergy::foldInto(Level& larger, const Level& smaller) const {
  const auto ratio = static_cast<std::size_t>(larger.side / smaller.side);
  tbb::parallel_for(std::size_t{0}, larger.blocks.size(), [&](std::size_t b) {
    Block& block = larger.blocks[b];
    for (std::size_t i = b * ratio; i < std::min(smaller.blocks.size(), (b + 1) * ratio); ++i) {
      const Block& part = smaller.blocks[i];
      if (part.texels == 0) continue;
      if (block.texels == 0) {
        block.gram = part.gram;
      } else {
        block.gram += part.gram;
      }
      block.texels += part.texels;
    }
  });
}

void BlockRankEnergy::shareWith(SharedGrams& grams, double weight) {
  assert(!keepsSamples());
  shared_ = &grams;
  shared_weight_ = weight;
}

std::size_t BlockRankEnergy::smallestBlocks() const {
  const int side = levels_.front().side;
  return static_cast<std::size_t>(blocksAcross(width_, side)) * static_cast<std::size_t>(blocksAcross(height_, side));
}

std::vector<RankEnergy> BlockRankEnergy::energiesOf(const SharedGrams& grams) const {
  std::vector<int> sides;
  for (const Level& level : levels_) sides.push_back(level.side);
  BlockRankEnergy sum(sides, width_, height_, channels_, expressions_);
  std::vector<Block>& row = sum.levels_.front().blocks;
  for (std::size_t first = 0; first < smallestBlocks(); first += row.size()) {
    for (std::size_t b = 0; b < row.size(); ++b) {
      row[b].gram = grams.gram(first + b);
      row[b].texels = row[b].gram.size() > 0 ? 1 : 0;
    }
    sum.closeRow(0);
  }
  return sum.energies_;
}

// Takes the energies of a finished row of blocks, hands it to the next size and starts a new one.
void BlockRankEnergy::closeRow(std::size_t level_index) {
  Level& level = levels_[level_index];
  std::vector<Residual> residuals(level.blocks.size());
  tbb::parallel_for(std::size_t{0}, level.blocks.size(), [&](std::size_t b) {
    const Block& block = level.blocks[b];
    if (block.texels == 0) return;
    if (block.samples.empty()) {
      residuals[b] = residualsOf(block.gram);
      return;
    }
    const Eigen::Index rows = static_cast<Eigen::Index>(block.samples.size()) / expressions_;
    const Eigen::MatrixXd samples =
        Eigen::Map<const Eigen::MatrixXf>(block.samples.data(), expressions_, rows).cast<double>();
    residuals[b] = residualsOf(samples.transpose() * samples);
  });
  if (level_index == 0 && shared_ != nullptr) {
    const std::size_t first = static_cast<std::size_t>(level.row) * level.blocks.size();
    tbb::parallel_for(std::size_t{0}, level.blocks.size(), [&](std::size_t b) {
      if (level.blocks[b].texels > 0) shared_->add(first + b, level.blocks[b].gram, shared_weight_);
    });
  }
  RankEnergy& energy = energies_[level_index];
  for (std::size_t b = 0; b < residuals.size(); ++b) {
    for (std::size_t c = 0; c < residuals[b].size(); ++c) energy.residual[c] += residuals[b][c];
    energy.texels += level.blocks[b].texels;
  }
  ++level.row;
  const bool last_row = level.row == blocksAcross(height_, level.side);
  if (level_index + 1 < levels_.size()) {
    Level& larger = levels_[level_index + 1];
    foldInto(larger, level);
    if (last_row || level.row % (larger.side / level.side) == 0) closeRow(level_index + 1);
  }
  std::fill(level.blocks.begin(), level.blocks.end(), Block());
}

}  // namespace facezip::compress
