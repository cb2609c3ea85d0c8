#include "package/weight_atlas.hpp"

#include <gtest/gtest.h>

#include "image/image_file.hpp"
#include "sample_package.hpp"
#include "temporary_directory.hpp"

namespace facezip {
namespace {
namespace fs = std::filesystem;
using test::makeSample;
using test::SamplePackage;

/// [N][tile_height][tile_width][C], as PackageWriter::writeWeights takes it.
std::vector<std::byte> readWeights(const PackageDescription& description, int set, const fs::path& directory) {
  const PackageWeights& weights = description.weights[static_cast<std::size_t>(set)];
  const int cells = static_cast<int>(description.expressions.size()) * weights.tile_width * weights.tile_height;
  std::vector<std::byte> codes(static_cast<std::size_t>(cells * description.differences));
  package::readWeightAtlas(description, set, io::Folder(directory),
                           [&](int n, int y, int first, int count, std::span<const std::byte> row) {
                             for (std::size_t b = 0; b < row.size(); ++b) {
                               const int x = static_cast<int>(b) / count, i = first + static_cast<int>(b) % count;
                               const int cell = (n * weights.tile_height + y) * weights.tile_width + x;
                               codes[static_cast<std::size_t>(cell * description.differences + i)] = row[b];
                             }
                           });
  return codes;
}

TEST(WeightAtlas, ComesBackWhateverTheNumberOfChannels) {
  for (int differences = 1; differences <= 8; ++differences) {
    const test::TemporaryDirectory folder;
    SamplePackage sample = makeSample({{}}, 7, differences);
    test::writeSample(sample, folder.path());
    EXPECT_EQ(readWeights(sample.description, 0, folder.path()), sample.weights[0]) << differences;
    const std::vector<std::string>& files = sample.description.weights[0].files;
    ASSERT_EQ(files.size(), differences > 4 ? 2u : 1u);
    EXPECT_EQ(image::readImage(folder / "weights.png").shape.channels, std::min(differences, 4));
    if (differences > 4) {
      EXPECT_EQ(image::readImage(folder / "weights_1.png").shape.channels, differences - 4);
    }
  }
}

TEST(WeightAtlas, SetsAreFilesOfTheFirstMapThatUsesThem) {
  const test::TemporaryDirectory folder;
  SamplePackage sample = makeSample({{"albedo", 40, 24, 3, SampleType::kUint8, 8, 0},
                                     {"normal", 80, 48, 3, SampleType::kUint8, 8, 1},
                                     {"specular", 40, 24, 1, SampleType::kUint8, 4, 1},
                                     {"height", 13, 9, 1, SampleType::kFloat32, 4, 2}},
                                    5, 6);
  test::writeSample(sample, folder.path());
  const Package package = Package::open(folder.path());
  ASSERT_EQ(package.weightSets().size(), 3u);
  const std::vector<std::string> names[] = {{"albedo/weights.png", "albedo/weights_1.png"},
                                            {"normal/weights.png", "normal/weights_1.png"},
                                            {"height/weights.png", "height/weights_1.png"}};
  for (int set = 0; set < 3; ++set) {
    const PackageWeights& weights = package.weightSets()[static_cast<std::size_t>(set)];
    EXPECT_EQ(weights.files, names[set]);
    EXPECT_EQ(weights.scale, sample.description.weights[static_cast<std::size_t>(set)].scale);
    EXPECT_EQ(readWeights(package.description(), set, folder.path()), sample.weights[static_cast<std::size_t>(set)]);
  }
  EXPECT_EQ(package.weightSets()[1].tile_width, 10);
  EXPECT_EQ(package.weightSets()[2].tile_height, 3);
  EXPECT_EQ(package.maps()[2].weight_set, 1);
}

TEST(WeightAtlas, RepeatsEdgesInTheBorder) {
  const test::TemporaryDirectory folder;
  SamplePackage sample = makeSample();
  test::writeSample(sample, folder.path());
  const image::Image atlas = image::readImage(folder / "weights.png");
  const auto cell = [&](int x, int y) {
    return reinterpret_cast<const std::uint32_t*>(atlas.samples.data())[y * atlas.shape.width + x];
  };
  const PackageWeights& weights = sample.description.weights[0];
  const int width = weights.tile_width, height = weights.tile_height;
  const int left = width + 2;  // the second tile
  EXPECT_EQ(cell(left, 0), cell(left + 1, 1));
  EXPECT_EQ(cell(left + width + 1, height + 1), cell(left + width, height));
  EXPECT_EQ(cell(left + 2, 0), cell(left + 2, 1));
  EXPECT_EQ(cell(left, 2), cell(left + 1, 2));
}

TEST(WeightAtlas, IsNearSquareAndRefusesWhatNoGpuTakes) {
  PackageWeights weights;
  weights.tile_width = weights.tile_height = 256;
  package::arrangeAtlas(weights, 52);
  EXPECT_EQ(weights.columns, 8);
  EXPECT_EQ(weights.rows, 7);
  weights.tile_width = 4096;
  weights.tile_height = 4096;
  package::arrangeAtlas(weights, 9);
  EXPECT_THROW(package::arrangeAtlas(weights, 10), InputError);
  weights.tile_width = 16384;
  EXPECT_THROW(package::arrangeAtlas(weights, 1), InputError);
}

}  // namespace
}  // namespace facezip
