// Both halves of the alternating least squares: difference textures under given weights, weights under given textures.
#include "reference/weight_fit.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <random>
#include <vector>

#include "compress/difference.hpp"
#include "compress/difference_fit.hpp"
#include "compress/weight_system.hpp"
#include "compress/weight_window.hpp"
#include "reference/difference.hpp"
#include "synthetic_band.hpp"
#include "test_device.hpp"
#include "tolerances.hpp"

namespace facezip::compress {
namespace {

using image::SampleType;

struct Case {
  BandShape shape;
  int weight_scale;
  int textures;
  int first_row;   ///< of the band in the image
  int rows_below;  ///< texel rows of the image behind the band; 0 unless the band is whole tiles
};

void PrintTo(const Case& which, std::ostream* out) {
  *out << which.shape.width << "x" << which.shape.rows << "x" << which.shape.channels << " N" << which.shape.expressions
       << " s" << which.weight_scale << " C" << which.textures;
}

constexpr float kRidge = 0.01f;
constexpr float kSmoothness = 40.0f;
constexpr float kTrust = 15.0f;

/// Tiles with texel weights between 0 and 1 and one mask each: 1 where a difference texture is wanted.
TileMasks gridTiles(const BandShape& shape) {
  TileMasks tiles = test::makeTileMasks(shape, 1, 1, 5);
  std::mt19937_64 random(6);
  tiles.mask_weights.clear();
  tiles.mask_index.assign(tiles.tiles.size(), 0);
  tiles.mask_begin.clear();
  for (std::size_t t = 0; t <= tiles.tiles.size(); ++t) tiles.mask_begin.push_back(static_cast<int>(t));
  for (float& weight : tiles.texel_weights) {
    if (weight > 0.0f) weight = 0.25f + 0.75f * static_cast<float>(test::unitRandom(random));
    tiles.mask_weights.push_back(weight > 0.0f || random() % 2 == 0 ? 1.0f : 0.0f);
  }
  return tiles;
}

/// A band on the device above a window of random weights, and the same for the references.
class Problem {
 public:
  explicit Problem(const Case& which, device::KernelVariant variant = device::KernelVariant::kAuto)
      : which_(which),
        shape_(which.shape),
        host_tiles_(gridTiles(shape_)),
        tiles_(context()),
        space_(spaceOf(which)),
        window_(context(), space_),
        fit_(context(), space_, variant),
        system_(context(), space_, variant) {
    const test::SyntheticBand band = test::makeBand(shape_, 15);
    tiles_.upload(host_tiles_);
    const cl::Buffer samples = context().upload(band.samples, "samples");
    differences_ =
        context().allocate(differenceBufferBytes(shape_, host_tiles_.tiles.size()), CL_MEM_READ_WRITE, "differences");
    computeDifferences(context(), tiles_, shape_, samples, differences_);
    tile_at_ = context().upload(tileLookup(host_tiles_, shape_), "tile lookup");
    reference_differences_ = reference::differences(band.values, test::tilePositions(host_tiles_), shape_.width,
                                                    shape_.rows, shape_.channels, shape_.expressions,
                                                    static_cast<double>(image::unit255(shape_.sample_type)));
    makeWeights();
  }

  static device::DeviceContext& context() { return test::testDevice(); }

  static WeightSpace spaceOf(const Case& which) {
    const int image_rows = which.first_row + which.shape.rows + which.rows_below;
    return {(which.shape.width + which.weight_scale - 1) / which.weight_scale,
            (image_rows + which.weight_scale - 1) / which.weight_scale, which.textures, which.shape.expressions};
  }

  GridBand band() const { return {tiles_, shape_, differences_, which_.first_row, which_.weight_scale}; }

  /// Delta of texel t of a tile, N x channels.
  Eigen::MatrixXd delta(std::size_t tile, int t) const {
    Eigen::MatrixXd delta(shape_.expressions, shape_.channels);
    for (int n = 0; n < shape_.expressions; ++n) {
      for (int c = 0; c < shape_.channels; ++c) {
        delta(n, c) = reference_differences_[((tile * static_cast<std::size_t>(shape_.expressions) +
                                               static_cast<std::size_t>(n)) *
                                                  static_cast<std::size_t>(shape_.channels) +
                                              static_cast<std::size_t>(c)) *
                                                 256 +
                                             static_cast<std::size_t>(t)];
      }
    }
    return delta;
  }
  int x(std::size_t tile, int t) const { return host_tiles_.tiles[tile].x * 16 + t % 16; }
  int y(std::size_t tile, int t) const { return which_.first_row + host_tiles_.tiles[tile].y * 16 + t / 16; }
  float texelWeight(std::size_t tile, int t) const {
    return host_tiles_.texel_weights[tile * 256 + static_cast<std::size_t>(t)];
  }
  bool wanted(std::size_t tile, int t) const {
    return host_tiles_.mask_weights[tile * 256 + static_cast<std::size_t>(t)] > 0.0f;
  }
  std::size_t tileCount() const { return host_tiles_.tiles.size(); }

  /// The texels of the band with the given textures, [tile][C][channel][256].
  std::vector<reference::FitTexel> texels(const std::vector<float>& textures) const {
    std::vector<reference::FitTexel> result;
    for (std::size_t tile = 0; tile < tileCount(); ++tile) {
      for (int t = 0; t < 256; ++t) {
        if (texelWeight(tile, t) == 0.0f) continue;
        Eigen::MatrixXd d(which_.textures, shape_.channels);
        for (int i = 0; i < which_.textures; ++i) {
          for (int c = 0; c < shape_.channels; ++c)
            d(i, c) = static_cast<double>(textures[textureIndex(tile, i, c, t)]);
        }
        result.push_back({x(tile, t), y(tile, t), static_cast<double>(texelWeight(tile, t)), d, delta(tile, t)});
      }
    }
    return result;
  }

  std::size_t textureIndex(std::size_t tile, int i, int c, int t) const {
    return (tile * static_cast<std::size_t>(which_.textures * shape_.channels) +
            static_cast<std::size_t>(i * shape_.channels + c)) *
               256 +
           static_cast<std::size_t>(t);
  }

  std::vector<float> readTextures() const {
    std::vector<float> values(textureIndex(tileCount(), 0, 0, 0));
    context().read(fit_.textures(), values.data(), values.size() * sizeof(float), "textures");
    return values;
  }

  /// The window's weights put into a copy of the whole grid.
  reference::GridWeights currentWeights() const {
    reference::GridWeights grid = weights_;
    const std::vector<float> values = window_.weights();
    for (int row = window_.rows().begin; row < window_.rows().end; ++row) {
      for (int column = 0; column < grid.columns; ++column) {
        for (int i = 0; i < grid.textures; ++i) {
          for (int n = 0; n < grid.expressions; ++n) {
            grid.at(row, column, i, n) = static_cast<double>(
                values[((static_cast<std::size_t>(row - window_.rows().begin) * static_cast<std::size_t>(grid.columns) +
                         static_cast<std::size_t>(column)) *
                            static_cast<std::size_t>(grid.textures) +
                        static_cast<std::size_t>(i)) *
                           space_.lanes() +
                       static_cast<std::size_t>(n)]);
          }
        }
      }
    }
    return grid;
  }

  void addToSystem(double metric_weight) { system_.add(band(), tile_at_, fit_.textures(), window_, metric_weight); }

  const Case& which_;
  BandShape shape_;
  TileMasks host_tiles_;
  DeviceTiles tiles_;
  WeightSpace space_;
  WeightWindow window_;
  DifferenceFit fit_;
  WeightSystem system_;
  cl::Buffer differences_;
  cl::Buffer tile_at_;
  std::vector<double> reference_differences_;
  reference::GridWeights weights_;  ///< of the whole grid; floats

 private:
  void makeWeights() {
    std::mt19937_64 random(9);
    weights_ = {space_.columns, space_.rows, which_.weight_scale, space_.textures, space_.expressions, {}};
    weights_.values.resize(static_cast<std::size_t>(space_.columns * space_.rows * space_.textures) *
                           static_cast<std::size_t>(space_.expressions));
    for (double& value : weights_.values)
      value = static_cast<double>(static_cast<float>(2.0 * test::unitRandom(random) - 0.5));
    WindowRows rows;
    rows.begin = std::max(0, which_.first_row / which_.weight_scale - 1);
    rows.end = std::min(space_.rows, (which_.first_row + shape_.rows) / which_.weight_scale + 2);
    // One row at either end is not free, as in a window within an image.
    rows.free_begin = std::min(rows.begin + 1, rows.end);
    rows.free_end = std::max(rows.end - 1, rows.free_begin);
    std::vector<float> values(static_cast<std::size_t>(rows.count()) * space_.rowFloats(), 0.0f);
    std::size_t cell = 0;
    for (int row = rows.begin; row < rows.end; ++row) {
      for (int column = 0; column < space_.columns; ++column, ++cell) {
        for (int i = 0; i < space_.textures; ++i) {
          for (int n = 0; n < space_.expressions; ++n) {
            values[(cell * static_cast<std::size_t>(space_.textures) + static_cast<std::size_t>(i)) * space_.lanes() +
                   static_cast<std::size_t>(n)] = static_cast<float>(weights_.at(row, column, i, n));
          }
        }
      }
    }
    window_.set(rows, values, values);
  }
};

/// The variants that the device has.
std::vector<device::KernelVariant> variants() {
  std::vector<device::KernelVariant> has;
  for (const device::KernelVariant variant : {device::KernelVariant::kCpu, device::KernelVariant::kGpu}) {
    if (test::testDevice().resolve(variant) == variant) has.push_back(variant);
  }
  return has;
}

class WeightFit : public testing::TestWithParam<Case> {
 protected:
  void SetUp() override {
    const BandShape& shape = GetParam().shape;
    if (test::smallSizesOnly() && (GetParam().textures > 2 || shape.expressions * shape.width * shape.rows > 1100))
      GTEST_SKIP() << "small sizes only";
  }
};

TEST_P(WeightFit, DifferenceTexturesSolveEveryTexel) {
  for (const device::KernelVariant variant : variants()) {
    Problem problem(GetParam(), variant);
    problem.fit_.compute(problem.band(), problem.window_, kRidge);
    const std::vector<float> textures = problem.readTextures();
    const std::vector<FitError> errors = problem.fit_.errors();
    const double full_scale = problem.shape_.sample_type == SampleType::kFloat32 ? 510.0 : 255.0;
    for (std::size_t tile = 0; tile < problem.tileCount(); ++tile) {
      double weighted = 0.0;
      double plain = 0.0;
      double energy = 0.0;
      for (int t = 0; t < 256; ++t) {
        const Eigen::MatrixXd w = problem.weights_.texel(problem.x(tile, t), problem.y(tile, t));
        const Eigen::MatrixXd delta = problem.delta(tile, t);
        const Eigen::MatrixXd d = reference::fitDifference(w, delta, static_cast<double>(kRidge));
        // What rounding does to the solution grows with the condition of the system.
        const double condition = w.squaredNorm() / static_cast<double>(kRidge);
        for (int i = 0; i < problem.which_.textures; ++i) {
          for (int c = 0; c < problem.shape_.channels; ++c) {
            const double actual = static_cast<double>(textures[problem.textureIndex(tile, i, c, t)]);
            const double expected = problem.wanted(tile, t) ? d(i, c) : 0.0;
            ASSERT_NEAR(actual, expected, test::kSolveRelative * condition * full_scale) << tile << " " << t;
          }
        }
        if (problem.texelWeight(tile, t) == 0.0f) continue;
        const double error = (delta - w.transpose() * d).squaredNorm();
        weighted += error * static_cast<double>(problem.texelWeight(tile, t));
        plain += error;
        energy += delta.squaredNorm();
      }
      EXPECT_NEAR(errors[tile].weighted, weighted, test::kFitErrorRelative * energy);
      EXPECT_NEAR(errors[tile].plain, plain, test::kFitErrorRelative * energy);
    }
  }
}

TEST_P(WeightFit, RoundedTexturesAreCodesAndNearlyAsGood) {
  Problem problem(GetParam());
  const auto planes = static_cast<std::size_t>(problem.which_.textures * problem.shape_.channels);
  problem.fit_.compute(problem.band(), problem.window_, kRidge);
  std::vector<float> exact = problem.readTextures();
  std::vector<TextureEncoding> encoding;
  for (std::size_t plane = 0; plane < planes; ++plane) encoding.push_back(encodingFor({-300.0f, 200.0f}, 8));
  problem.fit_.computeRounded(problem.band(), problem.window_, kRidge, encoding, 8);
  const std::vector<float> rounded = problem.readTextures();
  const std::vector<FitError> errors = problem.fit_.errors();
  double at_once = 0.0;  // error of rounding each channel for itself
  double in_turn = 0.0;
  for (std::size_t tile = 0; tile < problem.tileCount(); ++tile) {
    double plain = 0.0;
    double energy = 0.0;
    for (int t = 0; t < 256; ++t) {
      Eigen::MatrixXd d(problem.which_.textures, problem.shape_.channels);
      Eigen::MatrixXd naive = d;
      for (int i = 0; i < problem.which_.textures; ++i) {
        for (int c = 0; c < problem.shape_.channels; ++c) {
          const TextureEncoding& e = encoding[static_cast<std::size_t>(i * problem.shape_.channels + c)];
          const float value = rounded[problem.textureIndex(tile, i, c, t)];
          const float code = (value - e.offset) / e.scale;
          ASSERT_EQ(value, e.scale * std::round(code) + e.offset);
          ASSERT_GE(code, 0.0f);
          ASSERT_LE(code, 255.0f);
          d(i, c) = static_cast<double>(value);
          naive(i, c) = static_cast<double>(
              e.scale * std::clamp(std::round((exact[problem.textureIndex(tile, i, c, t)] - e.offset) / e.scale), 0.0f,
                                   255.0f) +
              e.offset);
        }
      }
      if (problem.texelWeight(tile, t) == 0.0f) continue;
      const Eigen::MatrixXd w = problem.weights_.texel(problem.x(tile, t), problem.y(tile, t));
      const Eigen::MatrixXd delta = problem.delta(tile, t);
      plain += (delta - w.transpose() * d).squaredNorm();
      at_once += (delta - w.transpose() * naive).squaredNorm();
      energy += delta.squaredNorm() + (w.transpose() * d).squaredNorm();
    }
    in_turn += plain;
    EXPECT_NEAR(errors[tile].plain, plain, test::kFitErrorRelative * energy);
  }
  EXPECT_LE(in_turn, at_once * (1.0 + 1e-6));
}

TEST_P(WeightFit, SystemEqualsReference) {
  for (const device::KernelVariant variant : variants()) {
    Problem problem(GetParam(), variant);
    problem.fit_.compute(problem.band(), problem.window_, kRidge);
    problem.addToSystem(1.0);
    problem.addToSystem(0.5);
    const std::vector<reference::FitTexel> texels = problem.texels(problem.readTextures());
    const WindowRows& rows = problem.window_.rows();
    const std::size_t entries = problem.space_.systemEntries();
    std::vector<float> system(static_cast<std::size_t>(rows.count() * problem.space_.columns) * entries);
    Problem::context().read(problem.system_.equations(), system.data(), system.size() * sizeof(float), "system");
    const int c = problem.which_.textures;
    const std::size_t side_begin = entries - problem.space_.cellFloats();
    for (int row = rows.begin; row < rows.end; ++row) {
      for (int column = 0; column < problem.space_.columns; ++column) {
        const float* cell =
            system.data() + static_cast<std::size_t>((row - rows.begin) * problem.space_.columns + column) * entries;
        const Eigen::MatrixXd self = reference::systemBlock(problem.weights_, texels, row, column, row, column);
        const double scale = 1.0 + self.trace();
        for (int block = 0; block < 4; ++block) {
          const Eigen::MatrixXd expected =
              reference::systemBlock(problem.weights_, texels, row, column, row + block / 2, column + block % 2);
          for (int i = 0; i < c; ++i) {
            for (int j = 0; j <= i; ++j) {
              ASSERT_NEAR(static_cast<double>(cell[block * c * (c + 1) / 2 + i * (i + 1) / 2 + j]),
                          1.5 * expected(i, j), test::kSystemRelative * scale)
                  << row << " " << column << " block " << block;
            }
          }
        }
        const Eigen::MatrixXd sides = reference::systemSides(problem.weights_, texels, row, column);
        for (int i = 0; i < c; ++i) {
          for (int n = 0; n < problem.space_.expressions; ++n) {
            ASSERT_NEAR(static_cast<double>(cell[side_begin + static_cast<std::size_t>(i) * problem.space_.lanes() +
                                                 static_cast<std::size_t>(n)]),
                        1.5 * sides(i, n), test::kSystemRelative * (scale + sides.norm()));
          }
        }
      }
    }
  }
}

TEST_P(WeightFit, RelaxingMovesEveryFreeCellToItsMinimum) {
  for (const device::KernelVariant variant : variants()) {
    Problem problem(GetParam(), variant);
    problem.fit_.compute(problem.band(), problem.window_, kRidge);
    problem.addToSystem(1.0);
    const std::vector<reference::FitTexel> texels = problem.texels(problem.readTextures());
    reference::GridWeights expected = problem.weights_;
    const WindowRows& rows = problem.window_.rows();
    constexpr int kSweeps = 2;
    for (int step = 0; step < 4 * kSweeps; ++step) {
      for (int row = rows.free_begin; row < rows.free_end; ++row) {
        if (row % 2 != step / 2 % 2) continue;
        for (int column = step % 2; column < problem.space_.columns; column += 2) {
          reference::relaxCell(expected, problem.weights_, texels, row, column, static_cast<double>(kSmoothness),
                               static_cast<double>(kTrust));
        }
      }
    }
    problem.system_.relax(problem.window_, kSweeps, kSmoothness, kTrust);
    const reference::GridWeights actual = problem.currentWeights();
    for (std::size_t i = 0; i < expected.values.size(); ++i) {
      ASSERT_NEAR(actual.values[i], expected.values[i], test::kRelaxedWeight * (1.0 + std::abs(expected.values[i])))
          << i;
    }
  }
}

TEST_P(WeightFit, EveryHalfStepLowersTheObjective) {
  Problem problem(GetParam());
  double last = std::numeric_limits<double>::infinity();
  for (int sweep = 0; sweep < 4; ++sweep) {
    problem.fit_.compute(problem.band(), problem.window_, kRidge);
    const std::vector<reference::FitTexel> texels = problem.texels(problem.readTextures());
    const auto objective = [&] {
      return reference::objective(problem.currentWeights(), problem.weights_, texels, static_cast<double>(kRidge),
                                  static_cast<double>(kSmoothness), static_cast<double>(kTrust));
    };
    const double fitted = objective();
    EXPECT_LE(fitted, last * (1.0 + 1e-6));
    problem.system_.clear();
    problem.addToSystem(1.0);
    problem.system_.relax(problem.window_, 1, kSmoothness, kTrust);
    last = objective();
    EXPECT_LE(last, fitted * (1.0 + 1e-6));
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, WeightFit,
                         testing::Values(Case{{45, 37, 3, 7, SampleType::kUint8}, 8, 4, 0, 0},
                                         Case{{45, 32, 3, 5, SampleType::kUint8}, 8, 4, 32, 40},
                                         Case{{70, 48, 1, 18, SampleType::kUint16}, 16, 3, 16, 16},
                                         Case{{33, 16, 4, 4, SampleType::kFloat32}, 4, 2, 48, 3},
                                         Case{{80, 40, 3, 9, SampleType::kUint8}, 32, 5, 0, 0},
                                         Case{{20, 18, 2, 3, SampleType::kUint8}, 5, 1, 0, 0},
                                         Case{{40, 32, 3, 19, SampleType::kUint8}, 8, 8, 0, 0},
                                         Case{{7, 5, 3, 2, SampleType::kUint8}, 8, 4, 0, 0},
                                         Case{{20, 17, 2, 3, SampleType::kUint8}, 4, 2, 16, 0}));

}  // namespace
}  // namespace facezip::compress
