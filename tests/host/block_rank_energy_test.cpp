#include "rate/block_rank_energy.hpp"

#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <cstring>
#include <numeric>
#include <random>

namespace facezip {
namespace {
using compress::BlockRankEnergy;
using compress::RankEnergy;

/// Float samples of a map: neutral and N expressions, in units of full scale.
struct RandomMap {
  int width, height, channels, expressions;
  std::vector<float> samples;  ///< [N + 1][height][width][channels]

  float at(int image, int x, int y, int c) const {
    return samples[static_cast<std::size_t>(((image * height + y) * width + x) * channels + c)];
  }
};

/// Differences that are sums of `rank` products of a random texture and a random weight.
RandomMap randomMap(int width, int height, int channels, int expressions, int rank) {
  RandomMap map{width, height, channels, expressions, {}};
  std::mt19937_64 random(5);
  const auto draw = [&] { return static_cast<double>(random() % 2001) / 1000.0 - 1.0; };
  const Eigen::Index values = static_cast<Eigen::Index>(width) * height * channels;
  const Eigen::MatrixXd textures = Eigen::MatrixXd::NullaryExpr(values, rank, draw);
  const Eigen::MatrixXd weights = Eigen::MatrixXd::NullaryExpr(rank, expressions, draw);
  const Eigen::MatrixXd differences = textures * weights;
  map.samples.assign(static_cast<std::size_t>(values), 0.0f);
  for (int n = 0; n < expressions; ++n) {
    for (Eigen::Index i = 0; i < values; ++i) map.samples.push_back(static_cast<float>(differences(i, n)));
  }
  return map;
}

bool isCovered(int x, int y) { return (3 * x + 5 * y) % 7 != 0; }

/// The same by singular values of every block.
RankEnergy bySingularValues(const RandomMap& map, int side, int stride, int largest) {
  RankEnergy energy;
  for (int y0 = 0; y0 < map.height; y0 += side) {
    for (int x0 = 0; x0 < map.width; x0 += side) {
      if ((x0 / largest + 2 * (y0 / largest)) % stride != 0) continue;
      std::vector<std::vector<double>> rows;
      for (int y = y0; y < std::min(map.height, y0 + side); ++y) {
        for (int x = x0; x < std::min(map.width, x0 + side); ++x) {
          if (!isCovered(x, y)) continue;
          ++energy.texels;
          for (int c = 0; c < map.channels; ++c) {
            rows.emplace_back();
            for (int n = 1; n <= map.expressions; ++n) {
              rows.back().push_back(255.0 * static_cast<double>(map.at(n, x, y, c) - map.at(0, x, y, c)));
            }
          }
        }
      }
      if (rows.empty()) continue;
      Eigen::MatrixXd matrix(static_cast<Eigen::Index>(rows.size()), map.expressions);
      for (Eigen::Index r = 0; r < matrix.rows(); ++r) {
        for (Eigen::Index n = 0; n < matrix.cols(); ++n) {
          matrix(r, n) = rows[static_cast<std::size_t>(r)][static_cast<std::size_t>(n)];
        }
      }
      const Eigen::VectorXd values = Eigen::JacobiSVD<Eigen::MatrixXd>(matrix).singularValues();
      for (Eigen::Index c = 0; c <= RankEnergy::kMostComponents && c < values.size(); ++c) {
        energy.residual[static_cast<std::size_t>(c)] += values.tail(values.size() - c).squaredNorm();
      }
    }
  }
  return energy;
}

/// Adds the map in bands of `band_rows` rows.
void addMap(BlockRankEnergy& blocks, const RandomMap& map, int band_rows) {
  for (int begin = 0; begin < map.height; begin += band_rows) {
    const int rows = std::min(band_rows, map.height - begin);
    const compress::BandShape shape{map.width, rows, map.channels, map.expressions, image::SampleType::kFloat32};
    std::vector<float> samples;
    for (int image = 0; image <= map.expressions; ++image) {
      for (int y = begin; y < begin + rows; ++y) {
        for (int x = 0; x < map.width; ++x) {
          for (int c = 0; c < map.channels; ++c) samples.push_back(map.at(image, x, y, c));
        }
      }
    }
    std::vector<std::byte> bytes(samples.size() * sizeof(float));
    std::memcpy(bytes.data(), samples.data(), bytes.size());
    std::vector<std::uint32_t> texels;
    for (int y = 0; y < rows; ++y) {
      for (int x = 0; x < map.width; ++x) {
        if (isCovered(x, begin + y)) texels.push_back(static_cast<std::uint32_t>(y * map.width + x));
      }
    }
    blocks.addBand(begin, bytes, shape, texels);
  }
}

std::vector<RankEnergy> energiesOf(const RandomMap& map, std::vector<int> sides, int band_rows, int stride = 1) {
  BlockRankEnergy blocks(std::move(sides), map.width, map.height, map.channels, map.expressions, stride);
  addMap(blocks, map, band_rows);
  return blocks.energies();
}

/// Some channels of a map, as a map.
RandomMap channelsOf(const RandomMap& map, int first, int count) {
  RandomMap some{map.width, map.height, count, map.expressions, {}};
  for (int image = 0; image <= map.expressions; ++image) {
    for (int y = 0; y < map.height; ++y) {
      for (int x = 0; x < map.width; ++x) {
        for (int c = first; c < first + count; ++c) some.samples.push_back(map.at(image, x, y, c));
      }
    }
  }
  return some;
}

void expectSame(const RankEnergy& got, const RankEnergy& expected) {
  EXPECT_EQ(got.texels, expected.texels);
  for (std::size_t c = 0; c < got.residual.size(); ++c) {
    EXPECT_NEAR(got.residual[c], expected.residual[c], 1e-5 * expected.residual[0]) << "C = " << c;
  }
}

class BlockLimit : public testing::TestWithParam<int> {};

TEST_P(BlockLimit, IsWhatSingularValuesOfEveryBlockLeave) {
  // 12 expressions: blocks of 1 and 2 texels have fewer samples, larger ones more. Bands cut through blocks.
  const RandomMap map = randomMap(29, 37, 2, 12, 12);
  const auto energies = energiesOf(map, {GetParam()}, 16);
  ASSERT_EQ(energies.size(), 1u);
  expectSame(energies[0], bySingularValues(map, GetParam(), 1, GetParam()));
}

INSTANTIATE_TEST_SUITE_P(Sides, BlockLimit, testing::Values(1, 2, 3, 4, 8, 16, 32, 64));

TEST(BlockRankEnergies, OfSeveralSizesComeFromOnePass) {
  const RandomMap map = randomMap(45, 50, 3, 6, 6);
  const std::vector<int> sides = {4, 8, 16, 32};
  const auto energies = energiesOf(map, sides, 16);
  ASSERT_EQ(energies.size(), 4u);
  for (std::size_t i = 0; i < sides.size(); ++i) expectSame(energies[i], bySingularValues(map, sides[i], 1, 32));
  for (std::size_t i = 1; i < sides.size(); ++i) {
    EXPECT_GE(energies[i].residual[2], energies[i - 1].residual[2]) << "smaller blocks fit better";
  }
}

/// Maps that share weights are one map with all their channels; a map that counts four times is one of twice the
/// values.
TEST(BlockRankEnergies, OfMapsThatShareWeightsAreThoseOfAllTheirChannels) {
  const RandomMap whole = randomMap(45, 50, 3, 9, 9);
  RandomMap first = channelsOf(whole, 0, 1), rest = channelsOf(whole, 1, 2);
  for (float& value : rest.samples) value *= 0.5f;
  const std::vector<int> sides = {4, 8, 16};
  const auto blocksOf = [&sides](const RandomMap& map) {
    return BlockRankEnergy(sides, map.width, map.height, map.channels, map.expressions, 3);
  };
  BlockRankEnergy of_first = blocksOf(first), of_rest = blocksOf(rest);
  compress::SharedGrams grams(of_first.smallestBlocks(), 9);
  of_first.shareWith(grams, 1.0);
  of_rest.shareWith(grams, 4.0);
  addMap(of_first, first, 16);
  addMap(of_rest, rest, 16);
  const std::vector<RankEnergy> shared = of_first.energiesOf(grams);
  for (std::size_t i = 0; i < sides.size(); ++i) {
    const RankEnergy expected = bySingularValues(whole, sides[i], 3, 16);
    const RankEnergy alone = of_first.energies()[i], other = of_rest.energies()[i];
    for (std::size_t c = 0; c <= 8; ++c) {
      EXPECT_NEAR(shared[i].residual[c], expected.residual[c], 1e-5 * expected.residual[0]) << sides[i] << ' ' << c;
    }
    EXPECT_GT(shared[i].residual[2], (alone.residual[2] + 4.0 * other.residual[2]));
  }
}

TEST(BlockRankEnergies, StrideLooksAtASlantedLatticeOfTheLargestBlocks) {
  const RandomMap map = randomMap(45, 50, 1, 5, 5);
  const auto energies = energiesOf(map, {4, 8}, 16, 3);
  expectSame(energies[0], bySingularValues(map, 4, 3, 8));
  expectSame(energies[1], bySingularValues(map, 8, 3, 8));
}

TEST(BlockRankEnergies, DifferencesOfRankTwoLeaveNothingAboveTwo) {
  const RandomMap map = randomMap(32, 32, 3, 10, 2);
  const RankEnergy energy = energiesOf(map, {8}, 16)[0];
  EXPECT_GT(energy.residual[1], 0.01 * energy.residual[0]);
  for (std::size_t c = 2; c < energy.residual.size(); ++c) EXPECT_LT(energy.residual[c], 1e-9 * energy.residual[0]);
}

TEST(BlockRankEnergies, BandsDoNotChangeTheResult) {
  const RandomMap map = randomMap(40, 48, 3, 7, 7);
  const RankEnergy whole = energiesOf(map, {8}, 48)[0];
  const RankEnergy bands = energiesOf(map, {8}, 16)[0];
  EXPECT_EQ(whole.residual, bands.residual);  // 16 rows hold whole blocks: the same sums
}

}  // namespace
}  // namespace facezip
