// grid_problem.hpp - a band of texels above a window of the weight grid, on the device and for the references.
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <ostream>
#include <random>
#include <vector>

#include "compress/bands/difference.hpp"
#include "compress/refine/difference_fit.hpp"
#include "compress/refine/weight_system.hpp"
#include "compress/refine/weight_window.hpp"
#include "reference/difference.hpp"
#include "reference/weight_fit.hpp"
#include "synthetic_band.hpp"
#include "test_device.hpp"

namespace facezip::compress {

struct GridCase {
  BandShape shape;
  int weight_scale;
  int textures;
  int first_row;   ///< of the band in the image
  int rows_below;  ///< texel rows of the image behind the band; 0 unless the band is whole tiles
};

inline void PrintTo(const GridCase& which, std::ostream* out) {
  *out << which.shape.width << "x" << which.shape.rows << "x" << which.shape.channels << " N" << which.shape.expressions
       << " s" << which.weight_scale << " C" << which.textures;
}

/// Sizes that divide by nothing, bands in the middle of an image, every type of samples, one to eight textures.
inline const GridCase kGridCases[] = {{{45, 37, 3, 7, image::SampleType::kUint8}, 8, 4, 0, 0},
                                      {{45, 32, 3, 5, image::SampleType::kUint8}, 8, 4, 32, 40},
                                      {{70, 48, 1, 18, image::SampleType::kUint16}, 16, 3, 16, 16},
                                      {{33, 16, 4, 4, image::SampleType::kFloat32}, 4, 2, 48, 3},
                                      {{80, 40, 3, 9, image::SampleType::kUint8}, 32, 5, 0, 0},
                                      {{40, 32, 3, 19, image::SampleType::kUint8}, 8, 8, 0, 0},
                                      {{20, 17, 2, 3, image::SampleType::kUint8}, 4, 2, 16, 0}};

inline constexpr float kRidge = 0.01f;
inline constexpr float kSmoothness = 40.0f;
inline constexpr float kTrust = 15.0f;

/// Tiles with texel weights between 0 and 1 and one mask each: 1 where a difference texture is wanted.
inline TileMasks gridTiles(const BandShape& shape) {
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
class GridProblem {
 public:
  explicit GridProblem(const GridCase& which, device::KernelVariant variant = device::KernelVariant::kAuto)
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

  static WeightSpace spaceOf(const GridCase& which) {
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
    context().read(fit_.textures(), values, "textures");
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

  const GridCase& which_;
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
inline std::vector<device::KernelVariant> variants() {
  std::vector<device::KernelVariant> has;
  for (const device::KernelVariant variant : {device::KernelVariant::kCpu, device::KernelVariant::kGpu}) {
    if (test::testDevice().resolve(variant) == variant) has.push_back(variant);
  }
  return has;
}

}  // namespace facezip::compress
