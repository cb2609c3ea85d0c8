#include "compress/search/weight_map.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "compress/search/permutation_search.hpp"
#include "compress/search/texture_assignment.hpp"
#include "reference/weight_map.hpp"
#include "search_capture.hpp"
#include "test_device.hpp"
#include "tolerances.hpp"

namespace facezip::compress {
namespace {

using test::Masks;
using test::randomCapture;
using test::SearchCapture;
using test::testDevice;

/// Cells with 0 to `most` random masks of K, weights summing to 1.
CellMasks randomCells(std::size_t count, int masks, int most, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  CellMasks cells{{0}, {}, {}};
  for (std::size_t p = 0; p < count; ++p) {
    const int active = static_cast<int>(random() % static_cast<unsigned>(std::min(most, masks) + 1));
    std::vector<double> weights;
    double sum = 0.0;
    for (int j = 0; j < active; ++j) sum += weights.emplace_back(test::uniform(random) + 1.0);
    const int first = static_cast<int>(random() % static_cast<unsigned>(masks));
    for (int j = 0; j < active; ++j) {
      cells.mask_index.push_back((first + j) % masks);
      cells.mask_weights.push_back(static_cast<float>(weights[static_cast<std::size_t>(j)] / sum));
    }
    cells.cell_begin.push_back(static_cast<int>(cells.mask_index.size()));
  }
  return cells;
}

std::vector<int> randomTextures(int masks, int expressions, int clusters, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<int> textures;
  for (int i = 0; i < masks * expressions; ++i) {
    textures.push_back(static_cast<int>(random() % static_cast<unsigned>(clusters)));
  }
  return textures;
}

/// 255 W + 1/2 of texture i of expression n at a cell, which rounds down to the byte.
double expectedByte(const CellMasks& cells, std::size_t cell, std::span<const int> textures, int expressions, int i,
                    int n) {
  std::vector<std::pair<int, double>> masks;
  for (int entry = cells.cell_begin[cell]; entry < cells.cell_begin[cell + 1]; ++entry) {
    const auto e = static_cast<std::size_t>(entry);
    masks.emplace_back(cells.mask_index[e], static_cast<double>(cells.mask_weights[e]));
  }
  std::vector<std::vector<int>> rows;
  for (std::size_t first = 0; first < textures.size(); first += static_cast<std::size_t>(expressions)) {
    const auto row = textures.subspan(first, static_cast<std::size_t>(expressions));
    rows.emplace_back(row.begin(), row.end());
  }
  return 255.0 * reference::weight(masks, rows, i, n) + 0.5;
}

TEST(WeightMap, IsTheReferencesOnAwkwardSizes) {
  const std::vector<std::size_t> counts =
      test::smallSizesOnly() ? std::vector<std::size_t>{1, 67} : std::vector<std::size_t>{1, 7, 64, 333};
  for (const int expressions : {1, 4, 16, 17, 37}) {
    for (const int clusters : {1, 4, 5, 8}) {
      for (const std::size_t count : counts) {
        SCOPED_TRACE(testing::Message() << expressions << " expressions, " << clusters << " clusters, " << count
                                        << " cells");
        const CellMasks cells = randomCells(count, 11, 6, count);
        const std::vector<int> textures = randomTextures(11, expressions, clusters, 3);
        WeightMapper mapper(testDevice(), textures, 11, expressions, clusters);
        std::vector<std::uint8_t> bytes(mapper.outputBytes(count), 0xA5);
        mapper.fill(cells, 0, count, bytes);
        std::size_t at = 0;
        for (int n = 0; n < expressions; ++n) {
          for (std::size_t cell = 0; cell < count; ++cell) {
            for (int i = 0; i < clusters; ++i, ++at) {
              const double expected = expectedByte(cells, cell, textures, expressions, i, n);
              ASSERT_LE(bytes[at], expected + test::kWeightRounding) << n << ", " << cell << ", " << i;
              ASSERT_GT(bytes[at] + 1.0, expected - test::kWeightRounding) << n << ", " << cell << ", " << i;
            }
          }
        }
      }
    }
  }
}

TEST(WeightMap, RoundsHalfUpAndStaysWithinAByte) {
  // 0.5 is 127.5; three weights whose floats sum to more than 1; none.
  const CellMasks cells{{0, 2, 5, 5}, {0, 1, 0, 1, 2}, {0.5f, 0.5f, 0.33333337f, 0.33333337f, 0.3333334f}};
  WeightMapper mapper(testDevice(), std::vector{0, 1, 0}, 3, 1, 2);
  std::vector<std::uint8_t> bytes(6);
  mapper.fill(cells, 0, 3, bytes);
  EXPECT_THAT(bytes, testing::ElementsAre(128, 128, 170, 85, 0, 0));
  WeightMapper same(testDevice(), std::vector{0, 0, 0}, 3, 1, 2);
  same.fill(cells, 0, 3, bytes);
  EXPECT_THAT(bytes, testing::ElementsAre(255, 0, 255, 0, 0, 0));
}

TEST(WeightMap, RangesJoinToTheWhole) {
  constexpr int kExpressions = 5, kClusters = 4;
  const CellMasks cells = randomCells(100, 11, 6, 1);
  WeightMapper mapper(testDevice(), randomTextures(11, kExpressions, kClusters, 3), 11, kExpressions, kClusters);
  std::vector<std::uint8_t> whole(mapper.outputBytes(100));
  mapper.fill(cells, 0, 100, whole);
  // Rising, falling and empty ranges, so that pooled buffers are larger than what is asked of them.
  for (const auto& [first, count] :
       std::vector<std::pair<std::size_t, std::size_t>>{{0, 10}, {10, 60}, {70, 0}, {70, 7}, {77, 23}}) {
    std::vector<std::uint8_t> part(mapper.outputBytes(count));
    mapper.fill(cells, first, count, part);
    for (std::size_t n = 0; n < kExpressions; ++n) {
      for (std::size_t i = 0; i < count * kClusters; ++i) {
        ASSERT_EQ(part[n * count * kClusters + i], whole[(n * 100 + first) * kClusters + i])
            << first << ", " << n << ", " << i;
      }
    }
  }
}

TEST(WeightMap, WritesNothingBeyondItsOutput) {
  constexpr std::size_t kCells = 7, kBytes = 17 * kCells * 4, kCanary = 4096;
  device::DeviceContext& context = testDevice();
  const CellMasks cells = randomCells(kCells, 3, 3, 1);
  const std::vector<std::uint8_t> canary(kBytes + kCanary, 0xA5);
  const WeightMapLaunch launch{
      .cells = kCells,
      .expressions = 17,
      .clusters = 4,
      .first_entry = 0,
      .cell_begin = context.upload(cells.cell_begin, "begin"),
      .mask_index = context.upload(cells.mask_index, "index"),
      .mask_weights = context.upload(cells.mask_weights, "weights"),
      .texture_of = context.upload(packTextureOf(randomTextures(3, 17, 4, 1), 3, 17), "textures"),
      .weights = context.allocate(canary.size(), CL_MEM_READ_WRITE, "weights")};
  context.write(launch.weights, canary, "weights");
  launchWeightMap(context, launch);
  std::vector<std::uint8_t> bytes(canary.size());
  context.read(launch.weights, bytes, "weights");
  for (std::size_t i = kBytes; i < bytes.size(); ++i) ASSERT_EQ(bytes[i], 0xA5) << i;
}

/// Largest |sum_i D_i W_in - Delta_n| over texels and expressions, with Eq. 5 and 6 from the search's own results.
double reconstructionError(const SearchCapture& capture) {
  const GramMatrices grams = gramsOf(capture);
  const Clustering clustering = clusterFragments(testDevice(), grams, {.restarts = 16});
  const SeamTables tables = computeSeamTables(testDevice(), grams, clustering);
  const Permutation permutation = searchPermutation(tables, {.restarts = 100}).best;
  const std::vector<float> coefficients = differenceCoefficients(clustering, permutation);
  const std::vector<int> textures = textureOfExpression(clustering, permutation);
  const std::size_t n_count = capture.differences.size(), masks = capture.masks.size();
  double worst = 0.0;
  for (std::size_t p = 0; p < capture.texels(); ++p) {
    double d[4] = {};
    for (std::size_t k = 0; k < masks; ++k) {
      for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t n = 0; n < n_count; ++n) {
          const double coefficient = static_cast<double>(coefficients[(k * 4 + i) * n_count + n]);
          d[i] += capture.masks[k][p] * coefficient * capture.differences[n][p];
        }
      }
    }
    for (std::size_t n = 0; n < n_count; ++n) {
      double sum = 0.0;
      for (std::size_t k = 0; k < masks; ++k) {
        sum += capture.masks[k][p] * d[static_cast<std::size_t>(textures[k * n_count + n])];
      }
      worst = std::max(worst, std::abs(sum - capture.differences[n][p]));
    }
  }
  return worst;
}

// Issue of sigma against sigma^-1 in Eq. 6: only the right reading reproduces these.
TEST(Search, FourExpressionsOrFewerAreReproducedExactly) {
  for (const int expressions : {1, 2, 3, 4}) {
    SCOPED_TRACE(expressions);
    EXPECT_LT(reconstructionError(randomCapture(expressions, 7, 5, Masks::kHard)), 100.0 * test::kExactReconstruction);
    // Across soft seams as well: the search finds the permutation in which every texture is one expression all over.
    EXPECT_LT(reconstructionError(randomCapture(expressions, 7, 5, Masks::kSoft)), 100.0 * test::kExactReconstruction);
  }
}

TEST(Search, RepeatsOfFourExpressionsAreReproducedExactly) {
  for (const Masks kind : {Masks::kHard, Masks::kSoft}) {
    SearchCapture capture = randomCapture(4, 7, 5, kind);
    for (std::size_t n = 4; n < 11; ++n) capture.differences.push_back(capture.differences[n * n % 4]);
    EXPECT_LT(reconstructionError(capture), 100.0 * test::kExactReconstruction);
  }
  EXPECT_GT(reconstructionError(randomCapture(5, 7, 5)), 1.0);  // five are too many: the test can fail
}

}  // namespace
}  // namespace facezip::compress
