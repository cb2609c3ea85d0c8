#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "facezip/compress.hpp"
#include "facezip/evaluate.hpp"
#include "facezip/package.hpp"
#include "io/staged_directory.hpp"
#include "kind_capture.hpp"
#include "temporary_directory.hpp"
#include "test_device.hpp"

namespace facezip {
namespace {
using test::Kind;
using test::noise;
using test::testDevice;
using test::wrinkles;

double otherWrinkles(int x, int y, int c, int n) { return 0.5 * wrinkles(y, 80 - x, c, (7 * n + 3) % 12); }
double fourOfAKind(int x, int y, int c, int n) { return wrinkles(x, y, c, n % 4); }

/// A capture of two maps, compressed with shared weights and with weights of their own.
class WeightsPerMap : public testing::Test {
 protected:
  void write(const std::function<double(int, int, int, int)>& albedo,
             const std::function<double(int, int, int, int)>& normal, const std::string& description = "{}") {
    test::writeCapture(folder_ / "c", {"albedo", 8, 64, 64, image::SampleType::kUint8, albedo}, "albedo");
    test::writeCapture(folder_ / "c", {"normal", 8, 64, 64, image::SampleType::kUint8, normal}, "normal");
    io::writeTextFile(folder_ / "c/capture.json", description);
  }

  CompressReport compress(bool per_map, Method method = Method::kRefined) {
    return compress(per_map ? WeightSets::kPerMap : WeightSets::kShared, method);
  }

  CompressReport compress(WeightSets sets, Method method = Method::kRefined) {
    CompressOptions options;
    options.method = method;
    options.unit = "m";
    options.mask_radius = {5.0, geometry::LengthUnit::kCentimetre};
    options.differences = 3;
    options.weight_scale = 8;
    options.restarts = 10;
    options.cluster_restarts = 8;
    options.weight_sets = sets;
    return compressCapture(openCapture(folder_ / "c"), folder_ / "p", options, testDevice(), progress_);
  }
  Package package() const { return Package::open(folder_ / "p"); }

  /// RMSE of the maps of the package as decoded from disk.
  std::vector<double> decodedErrors() {
    const EvaluateOptions quick = {.methods = {}, .baselines = {}, .blends = 0};
    const Evaluation evaluation =
        evaluatePackage(openCapture(folder_ / "c"), package(), quick, testDevice(), progress_);
    return {evaluation.maps[0].rmse.at("package").pooled, evaluation.maps[1].rmse.at("package").pooled};
  }

  const test::TemporaryDirectory folder_;
  Progress progress_;
};

TEST_F(WeightsPerMap, AreASetOfEveryMapAndSuitUnrelatedMapsBetter) {
  write(wrinkles, otherWrinkles);
  for (const Method method : {Method::kRefined, Method::kClosedLoop}) {
    compress(false, method);
    EXPECT_EQ(package().weightSets().size(), 1u);
    const std::uint64_t shared_bytes = package().bytesInMemory();
    const std::vector<double> shared = decodedErrors();
    compress(true, method);
    ASSERT_EQ(package().weightSets().size(), 2u);
    EXPECT_EQ(package().maps()[0].weight_set, 0);
    EXPECT_EQ(package().maps()[1].weight_set, 1);
    EXPECT_EQ(package().bytesInMemory(), shared_bytes + 8u * 8 * 8 * 3);
    const std::vector<double> own = decodedErrors();
    for (std::size_t m = 0; m < 2; ++m) EXPECT_LE(own[m], 1.02 * shared[m]) << m;
    EXPECT_LT(own[0] + own[1], 0.9 * (shared[0] + shared[1]));
  }
}

TEST_F(WeightsPerMap, WorkWithEveryMethodAndAgreeWithTheReport) {
  write(wrinkles, otherWrinkles);
  for (const Method method : {Method::kRefined, Method::kPaper, Method::kNoPermutation}) {
    const CompressReport report = compress(true, method);
    EXPECT_EQ(package().weightSets().size(), 2u);
    const std::vector<double> errors = decodedErrors();
    for (std::size_t m = 0; m < report.rmse.size(); ++m)
      EXPECT_NEAR(errors[m], report.rmse[m].second, 1e-3 * errors[m]);
  }
}

/// The sum of the maps' Gram matrices starts from other bits than those of all maps together, but for the same thing.
TEST_F(WeightsPerMap, AreChosenWhereTheyPay) {
  write(wrinkles, otherWrinkles);
  EXPECT_EQ(compress(WeightSets::kAuto).weight_sets, 2);
  const std::vector<double> chosen = decodedErrors();
  EXPECT_EQ(compress(true).weight_sets, 2);
  EXPECT_EQ(chosen, decodedErrors());

  write(wrinkles, [](int x, int y, int c, int n) { return 0.8 * wrinkles(x, y, c, n); });  // they move as one
  EXPECT_EQ(compress(WeightSets::kAuto).weight_sets, 1);
  const std::vector<double> together = decodedErrors();
  EXPECT_EQ(compress(false).weight_sets, 1);
  const std::vector<double> shared = decodedErrors();
  for (std::size_t m = 0; m < 2; ++m) EXPECT_NEAR(together[m], shared[m], 0.02 * shared[m]) << m;
}

TEST_F(WeightsPerMap, AreSharedByMethodsThatFitNothing) {
  write(wrinkles, otherWrinkles);
  EXPECT_EQ(compress(WeightSets::kAuto, Method::kPaper).weight_sets, 1);
  EXPECT_EQ(package().weightSets().size(), 1u);
}

// A map is what it would be by itself, whatever the other is.
TEST_F(WeightsPerMap, AreThoseOfTheMapAlone) {
  write(wrinkles, otherWrinkles);
  compress(true);
  const double among = decodedErrors()[0];
  std::filesystem::remove_all(folder_ / "c/normal");
  const CompressReport alone = compress(true);
  EXPECT_EQ(package().weightSets().size(), 1u);
  EXPECT_NEAR(alone.rmse[0].second, among, 1e-3 * among);
}

// Where the paper's weights are exact for one map and not for the other, each keeps what is better for it.
TEST_F(WeightsPerMap, EveryMapKeepsTheBetterWeights) {
  const auto three = [](int x, int y, int c, int n) { return wrinkles(x, y, c, n % 3) - 2.0 * noise(x, y, c, n % 3); };
  write(three, otherWrinkles);
  compress(true, Method::kClosedLoop);
  const std::vector<double> closed = decodedErrors();
  compress(true);
  const std::vector<double> refined = decodedErrors();
  EXPECT_LE(refined[0], closed[0] * (1.0 + 1e-6));
  EXPECT_LT(refined[1], closed[1]);
}

// A metric weight is about the others: by itself a map is compressed in full.
TEST_F(WeightsPerMap, AMapOfNoWeightIsFittedAllTheSame) {
  write(wrinkles, fourOfAKind);
  compress(true);
  const std::vector<double> even = decodedErrors();
  write(wrinkles, fourOfAKind, R"({"maps": {"albedo": {}, "normal": {"weight": 0}}})");
  compress(true);
  EXPECT_EQ(package().maps()[1].metric_weight, 0.0);
  const std::vector<double> own = decodedErrors();
  for (std::size_t m = 0; m < 2; ++m) EXPECT_NEAR(own[m], even[m], 1e-6) << m;
  compress(false);
  EXPECT_LE(decodedErrors()[0], 1.02 * even[0]) << "shared weights are the other's alone";
}

TEST_F(WeightsPerMap, MapsOfNoWeightAtAllCountAlike) {
  write(wrinkles, otherWrinkles);
  compress(false);
  const std::vector<double> even = decodedErrors();
  write(wrinkles, otherWrinkles, R"({"maps": {"albedo": {"weight": 0}, "normal": {"weight": 0}}})");
  compress(false);
  const std::vector<double> none = decodedErrors();
  for (std::size_t m = 0; m < 2; ++m) EXPECT_NEAR(none[m], even[m], 1e-6) << m;
}

}  // namespace
}  // namespace facezip
