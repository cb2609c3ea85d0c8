#include "compress/compress_stretch.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <vector>

#include "canary_buffer.hpp"
#include "compress/bands/difference.hpp"
#include "compress/refine/refinement.hpp"
#include "reference/compress_stretch.hpp"
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
  int first_row;
};

void PrintTo(const Case& which, std::ostream* out) {
  *out << which.shape.width << "x" << which.shape.rows << "x" << which.shape.channels << " N" << which.shape.expressions
       << " s" << which.weight_scale;
}

class CompressStretch : public testing::TestWithParam<Case> {};

TEST_P(CompressStretch, EqualsReference) {
  const auto& [shape, scale, first_row] = GetParam();
  if (test::smallSizesOnly() && shape.expressions > 3) GTEST_SKIP() << "small sizes only";
  device::DeviceContext& context = test::testDevice();
  const test::SyntheticBand band = test::makeBand(shape, 3);
  TileMasks masks = test::makeTileMasks(shape, 1, 1, 5);
  std::mt19937_64 random(6);
  masks.mask_weights.clear();
  for (std::size_t i = 0; i < masks.tiles.size() * kTileTexels; ++i) {
    masks.mask_weights.push_back(random() % 3 == 0 || masks.texel_weights[i] <= 0.0f ? 0.0f : 1.0f);
  }
  masks.mask_index.assign(masks.tiles.size(), 0);
  masks.mask_begin.clear();
  for (std::size_t t = 0; t <= masks.tiles.size(); ++t) masks.mask_begin.push_back(static_cast<int>(t));
  DeviceTiles tiles(context);
  tiles.upload(masks);
  const cl::Buffer samples = context.upload(band.samples, "samples");
  const cl::Buffer differences =
      context.allocate(differenceBufferBytes(shape, masks.tiles.size()), CL_MEM_READ_WRITE, "differences");
  computeDifferences(context, tiles, shape, samples, differences);

  const int image_rows = first_row + shape.rows;
  const WeightSpace space{(shape.width + scale - 1) / scale, (image_rows + scale - 1) / scale, kCompressStretchMaps,
                          shape.expressions};
  std::vector<float> weights(static_cast<std::size_t>(space.rows) * space.rowFloats(), 0.0f);
  for (std::size_t i = 0; i < weights.size(); ++i) {
    if (static_cast<int>(i % space.lanes()) < shape.expressions)
      weights[i] = static_cast<float>(test::unitRandom(random));
  }
  // Cells that the host would not upload for this band are not to be touched.
  const WindowRows held = cellRowsOf(first_row, image_rows, scale, space.rows);
  std::vector<float> device_weights = weights;
  const auto row_begin = [&](int row) {
    return device_weights.begin() + row * static_cast<std::ptrdiff_t>(space.rowFloats());
  };
  std::fill(device_weights.begin(), row_begin(held.begin), std::numeric_limits<float>::quiet_NaN());
  std::fill(row_begin(held.end), device_weights.end(), std::numeric_limits<float>::quiet_NaN());
  WeightWindow window(context, space);
  window.set({0, space.rows, 0, space.rows}, device_weights, device_weights);
  const std::vector<double> of_tiles =
      reference::differences(band.values, test::tilePositions(masks), shape.width, shape.rows, shape.channels,
                             shape.expressions, static_cast<double>(image::unit255(shape.sample_type)));
  for (const bool gpu : {false, true}) {
    const test::CanaryBuffer textures(
        context, masks.tiles.size() * static_cast<std::size_t>(2 * shape.channels) * kTileTexels * sizeof(float));
    launchCompressStretch(context, {tiles, shape, differences, first_row, scale}, window, gpu, textures.buffer());
    context.finish();
    const std::vector<float> actual = textures.read<float>();
    const auto channels = static_cast<std::size_t>(shape.channels);
    for (std::size_t tile = 0; tile < masks.tiles.size(); ++tile) {
      for (std::size_t t = 0; t < kTileTexels; ++t) {
        const int x = masks.tiles[tile].x * kTileSide + static_cast<int>(t) % kTileSide;
        const int y = first_row + masks.tiles[tile].y * kTileSide + static_cast<int>(t) / kTileSide;
        for (std::size_t i = 0; i < 2; ++i) {
          for (std::size_t c = 0; c < channels; ++c) {
            double expected = 0.0;
            for (int n = 0; n < shape.expressions && masks.mask_weights[tile * kTileTexels + t] > 0.0f; ++n) {
              const double share =
                  reference::bilinear(x, y, scale, space.columns, space.rows, [&](int row, int column) {
                    return static_cast<double>(weights[static_cast<std::size_t>(row) * space.rowFloats() +
                                                       static_cast<std::size_t>(column) * space.cellFloats() +
                                                       i * space.lanes() + static_cast<std::size_t>(n)]);
                  });
              const std::size_t at =
                  ((tile * static_cast<std::size_t>(shape.expressions) + static_cast<std::size_t>(n)) * channels + c) *
                      kTileTexels +
                  t;
              expected += share * of_tiles[at];
            }
            ASSERT_NEAR(static_cast<double>(actual[((tile * 2 + i) * channels + c) * kTileTexels + t]), expected,
                        2e-3 * shape.expressions)
                << "tile " << tile << " texel " << t << " map " << i << " channel " << c << " gpu " << gpu;
          }
        }
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    Shapes, CompressStretch,
    testing::Values(Case{{93, 16, 3, 3, SampleType::kUint8}, 8, 0}, Case{{93, 10, 1, 1, SampleType::kUint8}, 8, 32},
                    Case{{7, 1, 4, 3, SampleType::kUint16}, 8, 16}, Case{{64, 16, 2, 2, SampleType::kFloat32}, 1, 0},
                    Case{{48, 32, 3, 20, SampleType::kUint8}, 5, 16}, Case{{33, 16, 3, 37, SampleType::kUint8}, 64, 0},
                    Case{{33, 16, 3, 2, SampleType::kUint8}, 64, 112},
                    Case{{20, 16, 3, 3, SampleType::kUint8}, 61, 640}));

TEST(CompressStretchLaunch, RefusesBuffersThatAreTooSmall) {
  device::DeviceContext& context = test::testDevice();
  const BandShape shape{40, 16, 3, 2, SampleType::kUint8};
  const TileMasks masks = test::makeTileMasks(shape, 3, 1, 2);
  DeviceTiles tiles(context);
  tiles.upload(masks);
  const WeightSpace space{5, 2, kCompressStretchMaps, 2};
  WeightWindow window(context, space);
  const std::vector<float> weights(2 * space.rowFloats(), 0.5f);
  window.set({0, 2, 0, 2}, weights, weights);
  const std::size_t bytes = differenceBufferBytes(shape, masks.tiles.size());
  const std::size_t out_bytes = masks.tiles.size() * 6 * kTileTexels * sizeof(float);
  const cl::Buffer differences = context.allocate(bytes, CL_MEM_READ_WRITE, "differences");
  const cl::Buffer few = context.allocate(bytes - 1, CL_MEM_READ_WRITE, "differences");
  const cl::Buffer out = context.allocate(out_bytes, CL_MEM_READ_WRITE, "maps");
  const cl::Buffer small = context.allocate(out_bytes - 1, CL_MEM_READ_WRITE, "maps");
  EXPECT_THROW(launchCompressStretch(context, {tiles, shape, few, 0, 8}, window, false, out), DeviceError);
  EXPECT_THROW(launchCompressStretch(context, {tiles, shape, differences, 0, 8}, window, false, small), DeviceError);
}

}  // namespace
}  // namespace facezip::compress
