#include "rate/rate_choice.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>

#include "facezip/compress.hpp"
#include "facezip/evaluate.hpp"
#include "facezip/package.hpp"
#include "io/staged_directory.hpp"
#include "kind_capture.hpp"
#include "temporary_directory.hpp"
#include "test_device.hpp"

namespace facezip {
namespace {
using test::testDevice;
namespace fs = std::filesystem;
using compress::chooseRate;
using compress::efficientPoints;
using compress::kRounding;
using compress::rateCurve;
using compress::RateFormats;
using compress::RateMap;
using test::Kind;
using test::noise;
using test::wrinkles;
using test::writeCapture;
using testing::ElementsAre;
using testing::HasSubstr;

const std::vector<RateFormats> kImages = {{}};

/// A map whose best C components leave (8 - C) / 8 of the energy at the first scale and as much more at each other.
RateMap evenMap(std::size_t scales) {
  RateMap map{100, 10, 1, 1, 1.0, 6000.0, 16.0, {}};
  for (std::size_t s = 0; s < scales; ++s) {
    map.left.emplace_back();
    for (int c = 0; c <= 8; ++c) map.left.back().push_back((8.0 - c) / 8.0 * (1.0 + 0.1 * static_cast<double>(s)));
  }
  return map;
}

TEST(RateCurve, HasEveryNumberOfTexturesAtEveryScale) {
  const std::vector<RateMap> maps = {evenMap(2)};
  const std::vector<int> scales = {4, 8};
  const std::vector<std::uint64_t> cells = {100, 25};
  const std::vector<RatePoint> curve = rateCurve(maps, scales, cells, 6, kImages);
  ASSERT_EQ(curve.size(), 16u);
  for (const RatePoint& point : curve) {
    const auto s = static_cast<std::size_t>(point.weight_scale == 8);
    const auto c = static_cast<std::uint64_t>(point.differences);
    EXPECT_EQ(point.code_bits, 8);
    EXPECT_EQ(point.bytes, 1000 * (1 + c) + cells[s] * 6 * c);
    EXPECT_NEAR(point.rmse, std::sqrt(16.0 * (maps[0].left[s][c] + kRounding)), 1e-12);
  }
}

TEST(RateCurve, PoolsMapsByWeightAndSize) {
  // Of map b there is a quarter of the samples, which count three times: 3/7 of the mean.
  RateMap a = evenMap(1);
  RateMap b = evenMap(1);
  b.width = 25;
  b.covered_samples = 1500.0;
  b.metric_weight = 3.0;
  b.mean_square = 100.0;
  const auto pooled = [](const RateMap& x, const RateMap& y) {
    return rateCurve(std::vector<RateMap>{x, y}, std::vector<int>{4}, std::vector<std::uint64_t>{100}, 6, kImages)[3];
  };
  const double left = 0.5 + kRounding;
  EXPECT_NEAR(pooled(a, b).rmse, std::sqrt(left * (4.0 / 7.0 * 16.0 + 3.0 / 7.0 * 100.0)), 1e-12);
  EXPECT_EQ(pooled(a, b).bytes, 5u * 1250 + 100 * 6 * 4);
  b.metric_weight = 0.0;
  EXPECT_NEAR(pooled(a, b).rmse, std::sqrt(left * 16.0), 1e-12) << "a map that does not count still takes its bytes";
  EXPECT_EQ(pooled(a, b).bytes, 5u * 1250 + 100 * 6 * 4);
  a.covered_samples = b.covered_samples = 0.0;
  EXPECT_EQ(pooled(a, b).rmse, 0.0);
}

TEST(RateCurve, MapsThatShareWeightsLeaveWhatIsLeftOfBoth) {
  RateMap map{10, 10, 1, 1, 1.0, 100.0, 4.0, {{1.0, 0.0, 0, 0, 0, 0, 0, 0, 0}}};
  RateMap other = map;
  other.metric_weight = 3.0;
  const std::vector<RateMap> maps = {map, other};
  const std::vector<int> scales = {8};
  const std::vector<std::uint64_t> cells = {10};
  const std::vector<std::vector<double>> left = {{1.0, 0.25, 0, 0, 0, 0, 0, 0, 0}};
  EXPECT_NEAR(compress::rateCurve(maps, scales, cells, 1, kImages)[0].rmse, std::sqrt(4.0 * compress::kRounding), 1e-9);
  EXPECT_NEAR(compress::rateCurve(maps, scales, cells, 1, kImages, left)[0].rmse,
              std::sqrt(4.0 * (0.25 + compress::kRounding)), 1e-9);
}

TEST(RateCurve, PreciseMapsHaveCodesOf16BitsToo) {
  RateMap map = evenMap(1);
  map.sample_bytes = 2;
  const RateMap coarse = evenMap(1);
  const std::vector<RatePoint> curve =
      rateCurve(std::vector<RateMap>{map, coarse}, std::vector<int>{4}, std::vector<std::uint64_t>{100}, 6, kImages);
  ASSERT_EQ(curve.size(), 16u);
  EXPECT_EQ(curve[14].code_bits, 8);
  EXPECT_EQ(curve[15].code_bits, 16);
  EXPECT_EQ(curve[14].bytes, 1000u * (2 + 8) + 1000 * (1 + 8) + 100 * 6 * 8);
  EXPECT_EQ(curve[15].bytes, 1000u * (2 + 16) + 1000 * (1 + 8) + 100 * 6 * 8);
  EXPECT_NEAR(curve[14].rmse, std::sqrt(16.0 * kRounding), 1e-12);
  EXPECT_NEAR(curve[15].rmse, std::sqrt(16.0 * kRounding * (1.0 + 1.0 / (257.0 * 257.0)) / 2.0), 1e-12);
}

// 100 x 10 texels of three channels are 25 x 3 blocks of 4 x 4; those of one channel become BC4's.
TEST(RateCurve, BlocksTakeTheirBytesAndAddTheirNoise) {
  RateMap colour = evenMap(1);
  colour.channels = 3;
  RateMap precise = evenMap(1);
  precise.sample_bytes = 2;
  precise.metric_weight = 0.0;
  const std::vector<RateFormats> formats = {{}, {BlockFormat::kBc7, BlockFormat::kBc1}};
  const auto curveOf = [&](const std::vector<RateMap>& maps) {
    return rateCurve(maps, std::vector<int>{4}, std::vector<std::uint64_t>{100}, 6, formats);
  };
  const RatePoint in_colour = curveOf({colour})[8 + 2];
  EXPECT_EQ(in_colour.texture_format, BlockFormat::kBc7);
  EXPECT_EQ(in_colour.difference_format, BlockFormat::kBc1);
  EXPECT_EQ(in_colour.bytes, 75u * 16 + 3 * 75 * 8 + 100 * 6 * 3);
  const double noise = compress::codingNoise(BlockFormat::kBc1);
  EXPECT_NEAR(in_colour.rmse, std::sqrt(16.0 * (5.0 / 8.0 + kRounding + 3.0 * noise)), 1e-12);
  EXPECT_EQ(curveOf({evenMap(1)})[8 + 2].bytes, 75u * 8 + 3 * 75 * 8 + 100 * 6 * 3) << "BC4";

  const RatePoint kept = curveOf({colour, precise})[16 + 4];
  EXPECT_EQ(kept.code_bits, 8);
  EXPECT_EQ(kept.bytes, in_colour.bytes + 1000 * (2 + 3)) << "maps of more than 8 bits stay images";
  EXPECT_NEAR(kept.rmse, in_colour.rmse, 1e-12);
}

TEST(CodingNoise, FallsWithTheBitsOfATexel) {
  EXPECT_LT(compress::codingNoise(BlockFormat::kBc7), compress::codingNoise(BlockFormat::kBc1));
  double last = 0.0;
  for (const BlockFormat format : {BlockFormat::kAstc4x4, BlockFormat::kAstc5x5, BlockFormat::kAstc6x6,
                                   BlockFormat::kAstc8x8, BlockFormat::kAstc10x10, BlockFormat::kAstc12x12}) {
    EXPECT_GT(compress::codingNoise(format), last);
    last = compress::codingNoise(format);
  }
}

RatePoint point(std::uint64_t bytes, double rmse) { return {1, 8, 8, std::nullopt, std::nullopt, bytes, rmse}; }

TEST(OwnWeights, PayWhereTheyBeatTheSameBytesOfTextures) {
  const auto with = [](int differences, bool own, std::uint64_t bytes, double rmse) {
    RatePoint one = point(bytes, rmse);
    one.differences = differences;
    one.weights_per_map = own;
    return one;
  };
  // 100 bytes more take the error of shared weights from 4 to 1; 50 of them would take it to 2.
  std::vector<RatePoint> curve = {with(3, false, 200, 8.0), with(4, false, 300, 4.0), with(5, false, 400, 1.0),
                                  with(4, true, 350, 1.9)};
  EXPECT_TRUE(compress::ownWeightsPay(curve, 4));
  curve.back().rmse = 2.1;
  EXPECT_FALSE(compress::ownWeightsPay(curve, 4));
  // Beyond the most textures the last step goes on.
  curve = {with(7, false, 700, 4.0), with(8, false, 800, 2.0), with(8, true, 900, 0.9)};
  EXPECT_TRUE(compress::ownWeightsPay(curve, 8));
  curve.back().rmse = 1.1;
  EXPECT_FALSE(compress::ownWeightsPay(curve, 8));
  curve = {with(1, false, 100, 0.0), with(2, false, 200, 0.0), with(1, true, 110, 0.0)};
  EXPECT_FALSE(compress::ownWeightsPay(curve, 1)) << "nothing changes";
}

TEST(EfficientPoints, AreBeatenByNoOther) {
  EXPECT_THAT(efficientPoints({point(50, 2.0), point(10, 9.0), point(40, 2.0), point(20, 9.0), point(40, 3.0),
                               point(30, 5.0), point(60, 2.5), point(70, 1.0)}),
              ElementsAre(point(10, 9.0), point(30, 5.0), point(40, 2.0), point(70, 1.0)));
  EXPECT_THAT(efficientPoints({}), testing::IsEmpty());
  EXPECT_THAT(efficientPoints({point(20, 0.0), point(10, 0.0)}), ElementsAre(point(10, 0.0)));
}

TEST(ChooseRate, TakesTheSmallestThatReachesTheTarget) {
  const std::vector<RatePoint> curve = {point(10, 9.0), point(30, 5.0), point(40, 2.0), point(70, 1.0)};
  const auto none = std::nullopt;
  EXPECT_EQ(chooseRate(curve, 5.0, none, 1.0), curve[1]) << "at most, not below";
  EXPECT_EQ(chooseRate(curve, 4.9, none, 1.0), curve[2]);
  EXPECT_EQ(chooseRate(curve, 100.0, none, 1.0), curve[0]);
  EXPECT_EQ(chooseRate(curve, 0.9, none, 1.0), none);
  EXPECT_EQ(chooseRate(curve, 5.0, none, 1.01), curve[2]) << "errors are larger than the estimate";
  EXPECT_EQ(chooseRate(curve, 5.0, none, 6.0), none);
}

TEST(ChooseRate, KeepsTheBudget) {
  const std::vector<RatePoint> curve = {point(10, 9.0), point(30, 5.0), point(40, 2.0), point(70, 1.0)};
  const auto none = std::nullopt;
  EXPECT_EQ(chooseRate(curve, none, 69, 1.0), curve[2]);
  EXPECT_EQ(chooseRate(curve, none, 70, 1.0), curve[3]) << "at most, not below";
  EXPECT_EQ(chooseRate(curve, none, 1000, 5.0), curve[3]);
  EXPECT_EQ(chooseRate(curve, none, 9, 1.0), none);
  EXPECT_EQ(chooseRate(curve, 5.0, 69, 1.0), curve[1]) << "the smallest, not the best";
  EXPECT_EQ(chooseRate(curve, 1.0, 69, 1.0), none);
  EXPECT_EQ(chooseRate(curve, 1.0, 70, 1.0), curve[3]);
  EXPECT_EQ(chooseRate({}, none, 1000, 1.0), none);
}

/// Collects notes.
class Notes : public Progress {
 public:
  void note(std::string_view text) override { text_ += std::string(text) + "\n"; }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

/// A capture on disk and what is made of it.
class Choosing : public testing::Test {
 protected:
  static CompressOptions options() {
    CompressOptions options;
    options.unit = "m";
    options.mask_radius = {5.0, geometry::LengthUnit::kCentimetre};
    options.restarts = 10;
    options.cluster_restarts = 8;
    return options;
  }
  static CompressOptions target(double rmse) {
    CompressOptions wanted = options();
    wanted.target_rmse = rmse;
    return wanted;
  }
  static CompressOptions budget(std::uint64_t bytes) {
    CompressOptions wanted = options();
    wanted.budget_bytes = bytes;
    return wanted;
  }

  CompressReport run(const CompressOptions& wanted) {
    return compressCapture(openCapture(folder_ / "c"), folder_ / "p", wanted, testDevice(), progress_);
  }
  Package package() const { return Package::open(folder_ / "p"); }

  /// Of the package as decoded from disk: pooled over the maps by their metric weights and sizes.
  double pooledRmse() {
    const Package made = package();
    const EvaluateOptions quick = {.methods = {}, .baselines = {}, .blends = 0};
    const Evaluation evaluation = evaluatePackage(openCapture(folder_ / "c"), made, quick, testDevice(), progress_);
    double error = 0.0;
    double samples = 0.0;
    for (std::size_t m = 0; m < evaluation.maps.size(); ++m) {
      const PackageMap& map = made.maps()[m];
      const double weight = map.metric_weight * map.width * map.height * map.channels;
      error += weight * std::pow(evaluation.maps[m].rmse.at("package").pooled, 2);
      samples += weight;
    }
    return std::sqrt(error / samples);
  }

  /// The message of the InputError that compressing fails with; nothing may be left behind.
  std::string failure(const CompressOptions& wanted) {
    std::string message = "no error";
    try {
      run(wanted);
    } catch (const InputError& error) {
      message = error.what();
    }
    EXPECT_EQ(std::distance(fs::directory_iterator(folder_.path()), fs::directory_iterator()), 1) << "something left";
    return message;
  }

  static void expectCurve(const CompressReport& report) {
    ASSERT_FALSE(report.rate_curve.empty());
    for (std::size_t i = 1; i < report.rate_curve.size(); ++i) {
      EXPECT_GT(report.rate_curve[i].bytes, report.rate_curve[i - 1].bytes);
      EXPECT_LT(report.rate_curve[i].rmse, report.rate_curve[i - 1].rmse);
    }
    ASSERT_TRUE(report.rate.has_value());
    EXPECT_THAT(report.rate_curve, testing::Contains(*report.rate));
    EXPECT_EQ(report.rate->differences, report.differences);
    EXPECT_EQ(report.rate->weight_scale, report.weight_scale);
  }

  const test::TemporaryDirectory folder_;
  Notes progress_;
};

TEST_F(Choosing, TargetIsMetAndTheNextSmallerPointWasNotExpectedTo) {
  writeCapture(folder_ / "c", {"wrinkles", 10, 64, 64, image::SampleType::kUint8, wrinkles});
  for (const double rmse : {3.0, 1.2}) {
    const CompressReport report = run(target(rmse));
    expectCurve(report);
    EXPECT_LE(pooledRmse(), rmse * (1.0 + 1e-5));
    EXPECT_EQ(package().bytesInMemory(), report.rate->bytes);
    EXPECT_EQ(package().differences(), report.differences);
    EXPECT_EQ(package().maps()[0].weight_scale, report.weight_scale);
    for (const RatePoint& smaller : report.rate_curve) {
      if (smaller == report.rate) break;
      EXPECT_GT(smaller.rmse, rmse) << "no attempt was needed, so the estimate decided";
    }
  }
  EXPECT_EQ(progress_.text(), "");
}

TEST_F(Choosing, BudgetIsKeptWithTheBestThatFits) {
  writeCapture(folder_ / "c", {"wrinkles", 10, 64, 64, image::SampleType::kUint8, wrinkles});
  for (const std::uint64_t bytes : {40000u, 80000u}) {
    const CompressReport report = run(budget(bytes));
    expectCurve(report);
    EXPECT_LE(package().bytesInMemory(), bytes);
    EXPECT_EQ(package().bytesInMemory(), report.rate->bytes);
    for (const RatePoint& point : report.rate_curve) {
      EXPECT_TRUE(point.bytes > bytes || point.rmse >= report.rate->rmse);
    }
    EXPECT_NEAR(report.rmse[0].second, report.rate->rmse, 0.3 * report.rate->rmse);
  }
}

TEST_F(Choosing, ExactBudgetIsEnoughAndOneByteLessTakesTheNextSmaller) {
  writeCapture(folder_ / "c", {"wrinkles", 8, 48, 48, image::SampleType::kUint8, wrinkles});
  const CompressReport report = run(target(3.0));
  const std::size_t taken = static_cast<std::size_t>(
      std::find(report.rate_curve.begin(), report.rate_curve.end(), *report.rate) - report.rate_curve.begin());
  ASSERT_GT(taken, 0u);
  CompressOptions both = target(3.0);
  both.budget_bytes = report.rate->bytes;
  EXPECT_EQ(run(both).rate, report.rate);
  EXPECT_LE(pooledRmse(), 3.0 * (1.0 + 1e-5));
  EXPECT_EQ(run(budget(report.rate->bytes - 1)).rate, report.rate_curve[taken - 1]);
}

TEST_F(Choosing, MapsOfOtherSizesAndSetsOfWeightsCountTheirBytes) {
  writeCapture(folder_ / "c", {"large", 8, 64, 64, image::SampleType::kUint8, wrinkles}, "albedo");
  writeCapture(folder_ / "c",
               {"small", 8, 32, 32, image::SampleType::kUint8,
                [](int x, int y, int c, int n) { return 0.6 * wrinkles(2 * x, 2 * y, c, n + 2); }},
               "detail");
  io::writeTextFile(folder_ / "c/capture.json", R"({"maps": {"albedo": {"weight": 2}, "detail": {}}})");
  for (const bool per_map : {false, true}) {
    CompressOptions wanted = target(2.5);
    wanted.weight_sets = per_map ? WeightSets::kPerMap : WeightSets::kShared;
    const CompressReport report = run(wanted);
    expectCurve(report);
    EXPECT_LE(pooledRmse(), 2.5 * (1.0 + 1e-3)) << "covered texels are not quite as the sizes";
    EXPECT_EQ(package().weightSets().size(), per_map ? 2u : 1u);
    EXPECT_EQ(package().bytesInMemory(), report.rate->bytes);
    const auto c = static_cast<std::uint64_t>(report.differences);
    const auto side = static_cast<std::uint64_t>((64 + report.weight_scale - 1) / report.weight_scale);
    EXPECT_EQ(report.rate->bytes, (64u * 64 + 32 * 32) * 3 * (1 + c) + side * side * 8 * c * (per_map ? 2 : 1));
  }
}

/// Two maps of two textures each, which follow the expressions in ways of their own: two textures are enough for
/// either, and far from enough for weights that serve both.
TEST_F(Choosing, ErrorsOfMapsThatShareWeightsAreExpectedOfThemTogether) {
  const auto mixed = [](int phase) {
    return [phase](int x, int y, int c, int n) {
      return 25.0 * std::sin(0.5 * x + c) * std::sin(1.3 * n + phase) +
             25.0 * std::sin(0.6 * y + phase) * std::cos(2.1 * n * (phase + 1));
    };
  };
  writeCapture(folder_ / "c", {"one", 12, 64, 64, image::SampleType::kUint8, mixed(0)}, "albedo");
  writeCapture(folder_ / "c", {"other", 12, 64, 64, image::SampleType::kUint8, mixed(1)}, "normal");
  CompressOptions wanted = budget(95000);
  wanted.weight_sets = WeightSets::kShared;
  const CompressReport report = run(wanted);
  ASSERT_TRUE(report.pooled_rmse);
  EXPECT_NEAR(*report.pooled_rmse, pooledRmse(), 1e-3);
  EXPECT_GT(report.rate->rmse, 3.0);
  EXPECT_NEAR(report.rate->rmse, *report.pooled_rmse, 0.2 * *report.pooled_rmse);
  wanted.weight_sets = WeightSets::kPerMap;
  const CompressReport alone = run(wanted);
  EXPECT_LT(alone.rate->rmse, 0.5 * report.rate->rmse);
}

// Codes of 16 bits double the difference textures: they are taken only where the budget holds them.
TEST_F(Choosing, PreciseMapsKeepTheBudget) {
  const auto smooth = [](int x, int y, int c, int n) { return wrinkles(x, y, c, n) - 2.0 * noise(x, y, c, n); };
  writeCapture(folder_ / "c", {"smooth", 4, 48, 48, image::SampleType::kFloat32, smooth});
  // Three textures and a fourth in 8 bits; in 16 bits they would take 4 x 2 + 4 bytes a sample.
  const std::uint64_t samples = 48u * 48 * 3;
  CompressReport report = run(budget(samples * (4 + 4) + 2000));
  EXPECT_LE(package().bytesInMemory(), samples * (4 + 4) + 2000);
  EXPECT_EQ(package().bytesInMemory(), report.rate->bytes);
  report = run(budget(samples * (4 + 8) + 2000));
  EXPECT_EQ(package().maps()[0].difference_bits, 16);
  EXPECT_EQ(package().bytesInMemory(), report.rate->bytes);
  EXPECT_LT(report.rmse[0].second, 0.01);
  // A target that 8-bit codes cannot reach.
  report = run(target(0.01));
  EXPECT_EQ(report.rate->code_bits, 16);
  EXPECT_LE(pooledRmse(), 0.01);
}

// What was chosen is what was written, to the byte, and a larger budget errs less.
TEST_F(Choosing, ABudgetChoosesAmongFormats) {
  writeCapture(folder_ / "c", {"wrinkles", 6, 96, 96, image::SampleType::kUint8, wrinkles});
  double last = std::numeric_limits<double>::infinity();
  for (const std::uint64_t bytes : {6000, 12000, 40000}) {
    CompressOptions options = budget(bytes);
    options.format_choice = {BlockFormat::kAstc4x4, BlockFormat::kAstc6x6, BlockFormat::kAstc12x12};
    const CompressReport report = run(options);
    ASSERT_TRUE(report.rate && report.rate->difference_format);
    EXPECT_EQ(package().bytesInMemory(), report.rate->bytes);
    EXPECT_LE(report.rate->bytes, bytes);
    EXPECT_EQ(package().maps()[0].differences.front().format, report.rate->difference_format);
    EXPECT_LT(*report.pooled_rmse, last);
    last = *report.pooled_rmse;
  }
}

TEST_F(Choosing, ATargetInBlocksIsMet) {
  writeCapture(folder_ / "c", {"wrinkles", 6, 96, 96, image::SampleType::kUint8, wrinkles});
  CompressOptions options = target(3.0);
  options.texture_format = BlockFormat::kBc7;
  const CompressReport report = run(options);
  EXPECT_EQ(report.rate->texture_format, BlockFormat::kBc7);
  EXPECT_LE(*report.pooled_rmse, 3.0);
  EXPECT_NEAR(*report.pooled_rmse, pooledRmse(), 1e-3);
}

TEST_F(Choosing, FormatsToChooseFromWantABudgetOrTarget) {
  writeCapture(folder_ / "c", {"wrinkles", 2, 48, 48, image::SampleType::kUint8, wrinkles});
  CompressOptions options;
  options.format_choice = {BlockFormat::kBc7, BlockFormat::kBc1};
  EXPECT_THAT(failure(options), HasSubstr("--budget or --target-rmse beside it"));
  options.budget_bytes = 1 << 20;
  options.texture_format = BlockFormat::kBc7;
  EXPECT_THAT(failure(options), HasSubstr("one format where there is one for differences"));
}

TEST_F(Choosing, WhatCannotBeReachedIsRefused) {
  writeCapture(folder_ / "c", {"noise", 12, 48, 48, image::SampleType::kUint8,
                               [](int x, int y, int c, int n) { return 6.0 * noise(x, y, c, n); }});
  const std::string unreachable = failure(target(0.05));
  for (const char* part : {"--target-rmse", "expected at least ", "8 differences with weights at 1/4", "got 0.05"}) {
    EXPECT_THAT(unreachable, HasSubstr(part));
  }
  const std::string small = failure(budget(1000));
  for (const char* part : {"--budget", "expected at least 13", "1 difference with weights at 1/32", "got 1000"}) {
    EXPECT_THAT(small, HasSubstr(part));
  }
  CompressOptions both = target(1.5);
  both.budget_bytes = 30000;
  EXPECT_THAT(failure(both), HasSubstr("within the budget"));
  EXPECT_THAT(failure(target(std::nan(""))), HasSubstr("--target-rmse"));
  EXPECT_THAT(failure(target(-1.0)), HasSubstr("--target-rmse"));
  for (const auto& [method, name] : std::map<Method, std::string>{{Method::kClosedLoop, "closed-loop"},
                                                                  {Method::kPaper, "paper"},
                                                                  {Method::kNoPermutation, "no-permutation"}}) {
    CompressOptions wanted = budget(1u << 30);
    wanted.method = method;
    EXPECT_THAT(failure(wanted), testing::AllOf(HasSubstr("--method"), HasSubstr("got " + name)));
  }
}

// Steps at the blocks' edges suit blocks better than interpolated weights: a package that misses is tried again,
// larger.
TEST_F(Choosing, AMissedTargetIsTriedAgain) {
  writeCapture(folder_ / "c", {"coarse", 12, 384, 384, image::SampleType::kUint8, [](int x, int y, int c, int n) {
                                 return wrinkles(x / 4 * 4 / 5, y / 4 * 4 / 5, c, n);
                               }});
  const CompressReport report = run(target(1.4));
  expectCurve(report);
  EXPECT_THAT(progress_.text(), HasSubstr("trying more"));
  EXPECT_LE(pooledRmse(), 1.4 * (1.0 + 1e-5));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_ / "p/albedo"), fs::directory_iterator()),
            1 + report.differences);
}

// The sample of texels misses what changes here.
TEST_F(Choosing, ASmallChangeIsNotOverlooked) {
  writeCapture(folder_ / "c", {"corner", 6, 448, 448, image::SampleType::kUint8, [](int x, int y, int c, int n) {
                                 return x >= 232 && x < 250 && y >= 200 && y < 218 ? 40.0 * noise(x / 3, y / 3, c, n)
                                                                                   : 0.0;
                               }});
  const CompressReport report = run(target(0.3));
  expectCurve(report);
  EXPECT_GT(report.rate_curve.size(), 2u);
  EXPECT_LE(pooledRmse(), 0.3 * (1.0 + 1e-5));
}

TEST_F(Choosing, DegenerateCapturesAreTaken) {
  const auto nothing = [](int, int, int, int) { return 0.0; };
  writeCapture(folder_ / "c", {"nothing changes", 6, 48, 48, image::SampleType::kUint8, nothing});
  EXPECT_EQ(run(target(0.1)).differences, 1);
  EXPECT_EQ(pooledRmse(), 0.0);
  fs::remove_all(folder_ / "c");
  writeCapture(folder_ / "c", {"one expression", 1, 48, 48, image::SampleType::kUint8, wrinkles});
  EXPECT_EQ(run(budget(1u << 30)).differences, 1) << "more textures than expressions gain nothing";
  fs::remove_all(folder_ / "c");
  writeCapture(folder_ / "c", {"tiny", 5, 5, 7, image::SampleType::kUint8, wrinkles});
  expectCurve(run(target(10.0)));
  EXPECT_LE(pooledRmse(), 10.0 * (1.0 + 1e-5));
}

}  // namespace
}  // namespace facezip
