#include "facezip/package.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <nlohmann/json.hpp>

#include "file_contents.hpp"
#include "image/image_file.hpp"
#include "io/staged_directory.hpp"
#include "package/footprint.hpp"
#include "package/package_json.hpp"
#include "sample_package.hpp"
#include "temporary_directory.hpp"

namespace facezip {
namespace {
namespace fs = std::filesystem;
using nlohmann::json;
using test::contentsOf;
using test::makeSample;
using test::SamplePackage;

std::vector<std::byte> readSamples(const fs::path& file) { return image::readImage(file).samples; }

class PackageContents : public testing::TestWithParam<std::tuple<SampleType, int, int, int>> {};

TEST_P(PackageContents, ComeBackAsTheyWereWritten) {
  const auto& [type, channels, differences, bits] = GetParam();
  const test::TemporaryDirectory folder;
  SamplePackage sample = makeSample({{"albedo", 41, 23, channels, type, 8, 0, bits}}, 5, differences);
  test::writeSample(sample, folder / "package");
  const Package package = Package::open(folder / "package");
  EXPECT_EQ(package::packageJson(package.description()), package::packageJson(sample.description));
  EXPECT_EQ(package.expressions(), sample.description.expressions);
  EXPECT_EQ(package.maps()[0].differences[0].scale, sample.description.maps[0].differences[0].scale);
  EXPECT_EQ(json::parse(package.methodJson())["seed"], 5);
  EXPECT_EQ(readSamples(package.directory() / package.maps()[0].neutral_file), sample.neutrals[0]);
  for (std::size_t i = 0; i < sample.differences[0].size(); ++i) {
    EXPECT_EQ(readSamples(package.directory() / package.maps()[0].differences[i].file), sample.differences[0][i]) << i;
  }
}

INSTANTIATE_TEST_SUITE_P(
    TypesChannelsDifferences, PackageContents,
    testing::Combine(testing::Values(SampleType::kUint8, SampleType::kUint16, SampleType::kFloat32),
                     testing::Values(1, 2, 3, 4), testing::Values(1, 3, 4, 5, 8), testing::Values(8, 16)));

TEST(Package, CountsBytesAsTheRendererKeepsThem) {
  const test::TemporaryDirectory folder;
  SamplePackage sample =
      makeSample({{"albedo", 40, 24, 3, SampleType::kUint8, 8}, {"height", 20, 12, 1, SampleType::kFloat32, 4}});
  test::writeSample(sample, folder / "package");
  const Package package = Package::open(folder / "package" / "package.json");
  EXPECT_EQ(package.bytesInMemory(), 40u * 24 * 3 * 5 + 20u * 12 * (4 + 4) + 5u * 5 * 3 * 4);
  const std::uint64_t shared = package.bytesInMemory();
  std::uint64_t bytes = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder.path())) {
    if (entry.is_regular_file()) bytes += entry.file_size();
  }
  EXPECT_EQ(package.bytesOnDisk(), bytes);
  EXPECT_EQ(package.mapIndex("height"), 1);
  EXPECT_THROW(package.mapIndex("specular"), InputError);

  SamplePackage own =
      makeSample({{"albedo", 40, 24, 3, SampleType::kUint8, 8, 0}, {"height", 20, 12, 1, SampleType::kFloat32, 2, 1}});
  test::writeSample(own, folder / "own");
  EXPECT_EQ(Package::open(folder / "own").bytesInMemory(), shared + 10u * 6 * 5 * 4);
  SamplePackage fine =
      makeSample({{"albedo", 40, 24, 3, SampleType::kUint8, 8, 0, 16}, {"height", 20, 12, 1, SampleType::kFloat32, 4}});
  test::writeSample(fine, folder / "fine");
  EXPECT_EQ(Package::open(folder / "fine").bytesInMemory(), shared + 40u * 24 * 3 * 4);
}

TEST(PackageWriter, RefusesWhatCouldNotBeOpened) {
  const test::TemporaryDirectory folder;
  const auto refused = [&](const std::function<void(PackageDescription&)>& change) {
    PackageDescription description = makeSample().description;
    change(description);
    EXPECT_THROW(package::PackageWriter(description, folder.path()), InputError);
  };
  refused([](PackageDescription& d) { d.expressions[1] = d.expressions[0]; });
  refused([](PackageDescription& d) { d.expressions[1] = "a/b"; });
  refused([](PackageDescription& d) { d.expressions[1] = "\xff"; });
  refused([](PackageDescription& d) { d.expressions.clear(); });
  refused([](PackageDescription& d) { d.maps.clear(); });
  refused([](PackageDescription& d) { d.maps[0].width = 0; });
  refused([](PackageDescription& d) { d.maps[0].weight_scale = 0; });
  refused([](PackageDescription& d) { d.maps[0].weight_set = 1; });
  refused([](PackageDescription& d) { d.maps[0].weight_set = -1; });
  refused([](PackageDescription& d) { d.weights.push_back(d.weights[0]); });
  refused([](PackageDescription& d) { d.weights.clear(); });
  refused([](PackageDescription& d) { d.maps[0].differences.pop_back(); });
  refused([](PackageDescription& d) { d.maps[0].differences[0].scale[0] = std::numeric_limits<double>::quiet_NaN(); });
  refused([](PackageDescription& d) { d.maps[0].differences[0].offset[0] = -0.123; });
  refused([](PackageDescription& d) { d.maps[0].difference_bits = 12; });
  refused([](PackageDescription& d) { d.method_json = "{"; });
  refused([](PackageDescription& d) {
    d.maps[0].width = d.maps[0].height = 65536;
    d.maps[0].weight_scale = 1;
  });
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST(PackageWriter, DescriptionComesLastAndAnUnfinishedPackageLeavesNothing) {
  const test::TemporaryDirectory folder;
  const SamplePackage sample = makeSample();
  {
    io::StagedDirectory staged(folder / "package", package::footprint());
    package::PackageWriter writer(sample.description, staged.path());
    writer.writeNeutralRows(0, sample.neutrals[0], 24);
    writer.writeWeights(0, sample.weights[0]);
    EXPECT_FALSE(fs::exists(staged.path() / "package.json"));
  }
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST(PackageWriter, TheSameContentsGiveTheSameBytes) {
  const test::TemporaryDirectory folder;
  SamplePackage sample = makeSample({{"height", 40, 24, 3, SampleType::kFloat32, 8}});
  SamplePackage again = sample;
  test::writeSample(sample, folder / "a", 7);
  test::writeSample(again, folder / "b", 24);
  EXPECT_EQ(contentsOf(folder / "a/package.json"), contentsOf(folder / "b/package.json"));
  for (const std::string& name : test::imagesOf(sample.description)) {
    EXPECT_EQ(contentsOf(folder / "a" / name), contentsOf(folder / "b" / name)) << name;
  }
}

}  // namespace
}  // namespace facezip
