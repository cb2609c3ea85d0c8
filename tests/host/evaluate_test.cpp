#include "facezip/evaluate.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "facezip/compress.hpp"
#include "facezip/report.hpp"
#include "image/image_file.hpp"
#include "kind_capture.hpp"
#include "temporary_directory.hpp"
#include "test_device.hpp"

namespace facezip {
namespace {
using test::testDevice;
namespace fs = std::filesystem;

CompressOptions smallOptions() {
  CompressOptions options;
  options.method = Method::kPaper;
  options.unit = "m";
  options.mask_radius = {5.0, geometry::LengthUnit::kCentimetre};
  options.restarts = 10;
  options.cluster_restarts = 8;
  return options;
}

/// Without what compresses again.
EvaluateOptions quickOptions() {
  EvaluateOptions options;
  options.methods = {};
  return options;
}

/// A compressed capture.
class Evaluating : public testing::Test {
 protected:
  Package compress(const test::SmallCaptureOptions& capture, const CompressOptions& options = smallOptions()) {
    test::writeSmallCapture(folder_ / "c", capture);
    compressCapture(openCapture(folder_ / "c"), folder_ / "p", options, testDevice(), progress_);
    return Package::open(folder_ / "p");
  }
  Evaluation evaluate(const Package& package, const EvaluateOptions& options) {
    return evaluatePackage(openCapture(folder_ / "c"), package, options, testDevice(), progress_);
  }

  const test::TemporaryDirectory folder_;
  Progress progress_;
};

TEST_F(Evaluating, ThePackagesOwnMethodIsThePackage) {
  const Package package = compress({.expressions = 7});
  EvaluateOptions options;  // the paper's method is asked for, and not compressed again
  options.methods = {Method::kPaper};
  const Evaluation evaluation = evaluate(package, options);
  EXPECT_EQ(evaluation.method, "paper");
  EXPECT_EQ(evaluation.differences, 4);
  const Evaluation::Map& map = evaluation.maps[0];
  EXPECT_EQ(map.rmse.at("paper").pooled, map.rmse.at("package").pooled);
  EXPECT_EQ(map.rmse.at("paper").per_expression, map.rmse.at("package").per_expression);
  EXPECT_EQ(evaluation.bytes.at("paper"), evaluation.bytes.at("package"));
  for (const auto& [stage, seconds] : evaluation.seconds) EXPECT_EQ(stage.find("compressing"), std::string::npos);
}

TEST_F(Evaluating, OtherMethodsAreCompressedWithTheRecordedOptions) {
  CompressOptions compression = smallOptions();
  compression.differences = 2;
  const Package package = compress({.expressions = 7}, compression);
  EvaluateOptions options = quickOptions();
  options.methods.insert(Method::kNoPermutation);
  const Evaluation evaluation = evaluate(package, options);
  compression.method = Method::kNoPermutation;
  compressCapture(openCapture(folder_ / "c"), folder_ / "p", compression, testDevice(), progress_);
  const Evaluation direct = evaluate(Package::open(folder_ / "p"), quickOptions());
  EXPECT_EQ(evaluation.maps[0].rmse.at("no-permutation").pooled, direct.maps[0].rmse.at("package").pooled);
  EXPECT_EQ(evaluation.bytes.at("no-permutation"), direct.bytes.at("package"));
}

// The normals of this capture follow expressions that its albedo does not.
TEST_F(Evaluating, WeightsPerMapShowWhatSharingThemCosts) {
  test::writeCapture(folder_ / "c", {"albedo", 8, 64, 64, image::SampleType::kUint8, test::wrinkles}, "albedo");
  test::writeCapture(folder_ / "c",
                     {"normal", 8, 64, 64, image::SampleType::kUint8,
                      [](int x, int y, int c, int n) { return test::wrinkles(y, 80 - x, c, (7 * n + 3) % 12); }},
                     "normal");
  const Capture capture = openCapture(folder_ / "c");
  CompressOptions compression = smallOptions();
  compression.method = Method::kRefined;
  compression.differences = 3;
  compression.weight_sets = WeightSets::kShared;
  compressCapture(capture, folder_ / "p", compression, testDevice(), progress_);
  const Package shared = Package::open(folder_ / "p");
  EvaluateOptions options = quickOptions();
  EXPECT_FALSE(evaluate(shared, options).bytes.contains("weights-per-map")) << "only where it is asked for";
  options.baselines.insert(Baseline::kWeightsPerMap);
  const Evaluation evaluation = evaluate(shared, options);
  EXPECT_EQ(evaluation.bytes.at("weights-per-map"), evaluation.bytes.at("package") + 8u * 8 * 8 * 3);

  compression.weight_sets = WeightSets::kPerMap;
  compressCapture(capture, folder_ / "own", compression, testDevice(), progress_);
  const Evaluation direct = evaluate(Package::open(folder_ / "own"), options);
  for (std::size_t m = 0; m < 2; ++m) {
    const auto& rmse = evaluation.maps[m].rmse;
    EXPECT_EQ(rmse.at("weights-per-map").per_expression, direct.maps[m].rmse.at("package").per_expression);
    EXPECT_LT(rmse.at("weights-per-map").pooled, rmse.at("package").pooled);
    EXPECT_EQ(direct.maps[m].rmse.at("weights-per-map").pooled, direct.maps[m].rmse.at("package").pooled);
    EXPECT_TRUE(evaluation.maps[m].blends.contains("weights-per-map"));
  }
  EXPECT_EQ(direct.bytes.at("weights-per-map"), direct.bytes.at("package"));
  for (const auto& [stage, seconds] : direct.seconds) EXPECT_EQ(stage.find("compressing"), std::string::npos);
}

TEST_F(Evaluating, OneMapHasWeightsOfItsOwn) {
  const Package package = compress({.expressions = 5});
  EvaluateOptions options = quickOptions();
  options.baselines.insert(Baseline::kWeightsPerMap);
  const Evaluation evaluation = evaluate(package, options);
  EXPECT_EQ(evaluation.maps[0].rmse.at("weights-per-map").pooled, evaluation.maps[0].rmse.at("package").pooled);
  for (const auto& [stage, seconds] : evaluation.seconds) EXPECT_EQ(stage.find("compressing"), std::string::npos);
}

TEST_F(Evaluating, DetailAgreesWithTheDecodedTexels) {
  const Package package = compress({.expressions = 6});
  const Evaluation evaluation = evaluate(package, quickOptions());
  const auto& detail = evaluation.maps[0].detail.at("package");
  ASSERT_EQ(detail.per_expression.size(), 6u);
  double squares = 0.0;
  for (std::size_t n = 0; n < 6; ++n) {
    const TexelErrors& errors = detail.per_expression[n];
    EXPECT_EQ(errors.rmse, evaluation.maps[0].rmse.at("package").per_expression[n]);
    EXPECT_NEAR(errors.psnr, 20.0 * std::log10(255.0 / errors.rmse), 1e-9);
    EXPECT_LE(errors.p99, errors.max);
    EXPECT_GE(errors.max, errors.rmse);
    squares += errors.rmse * errors.rmse;
  }
  EXPECT_NEAR(detail.pooled.rmse, std::sqrt(squares / 6.0), 1e-9);
  EXPECT_EQ(
      detail.pooled.max,
      std::max_element(detail.per_expression.begin(), detail.per_expression.end(), [](const auto& a, const auto& b) {
        return a.max < b.max;
      })->max);
}

TEST_F(Evaluating, BlockLimitIsBelowEveryMethodAndPca) {
  const Package package = compress({.expressions = 12});
  const Evaluation evaluation = evaluate(package, quickOptions());
  const auto& rmse = evaluation.maps[0].rmse;
  EXPECT_LT(rmse.at("limit").pooled, rmse.at("pca4").pooled);
  EXPECT_LT(rmse.at("limit").pooled, rmse.at("package").pooled);
  EXPECT_TRUE(rmse.at("limit").per_expression.empty());
}

TEST_F(Evaluating, NormalMapsAreJudgedByAngle) {
  const Package package = compress({.expressions = 6, .maps = {"albedo", "normal"}});
  const Evaluation evaluation = evaluate(package, quickOptions());
  EXPECT_TRUE(evaluation.maps[0].angles.empty());
  const auto& angles = evaluation.maps[1].angles.at("package");
  ASSERT_EQ(angles.per_expression.size(), 6u);
  EXPECT_GT(angles.pooled.mean, 0.0);
  EXPECT_LT(angles.pooled.mean, angles.pooled.p99);
  EXPECT_LE(angles.pooled.p99, angles.pooled.max);
}

// Also of 8-bit maps: what a shader sees is neither rounded nor clamped.
TEST_F(Evaluating, BlendsStayWithinWhatLinearityAllows) {
  const Package package = compress({.expressions = 10});
  EvaluateOptions options = quickOptions();
  options.methods.insert(Method::kNoPermutation);
  const Evaluation evaluation = evaluate(package, options);
  ASSERT_EQ(evaluation.blend_weights.size(), 16u);
  const Evaluation::Map& map = evaluation.maps[0];
  for (const char* method : {"package", "no-permutation"}) {
    const BlendErrors& blends = map.blends.at(method);
    EXPECT_GT(blends.rmse, 0.0);
    EXPECT_LE(blends.largest_share_of_bound, 1.0 + 1e-3) << method;
    EXPECT_GT(blends.largest_share_of_bound, 0.3) << method;
  }
  // Blends keep the order and about the ratio of the methods at single expressions.
  const double corners = map.rmse.at("no-permutation").pooled / map.rmse.at("package").pooled;
  const double blends = map.blends.at("no-permutation").rmse / map.blends.at("package").rmse;
  EXPECT_GT(blends, 1.0);
  EXPECT_NEAR(std::log(blends / corners), 0.0, std::log(1.5));
}

TEST_F(Evaluating, BlendOfOneExpressionIsItsErrorScaled) {
  const Package package = compress({.expressions = 1, .type = image::SampleType::kFloat32, .extension = "exr"});
  EvaluateOptions options = quickOptions();
  options.blends = 3;
  const Evaluation evaluation = evaluate(package, options);
  const double rmse = evaluation.maps[0].rmse.at("package").pooled;
  double squares = 0.0;
  for (const auto& beta : evaluation.blend_weights) squares += std::pow(static_cast<double>(beta[0]) * rmse, 2);
  EXPECT_NEAR(evaluation.maps[0].blends.at("package").rmse, std::sqrt(squares / 3.0), 1e-3 * rmse);
  EXPECT_NEAR(evaluation.maps[0].blends.at("package").largest_share_of_bound, 1.0, 1e-3);
  options.blends = 0;
  EXPECT_TRUE(evaluate(package, options).maps[0].blends.empty());
}

TEST_F(Evaluating, AblationHasEveryMethodAtEveryNumberOfTextures) {
  CompressOptions compression = smallOptions();
  compression.differences = 3;
  compression.weight_sets = WeightSets::kShared;
  const Package package = compress({.expressions = 6, .maps = {"albedo", "normal"}}, compression);
  EvaluateOptions options = quickOptions();
  options.ablation = true;
  const Evaluation evaluation = evaluate(package, options);
  for (const Evaluation::Map& map : evaluation.maps) {
    for (const char* method : {"no-permutation", "paper", "closed-loop", "refined", "limit", "pca"}) {
      const auto& by_differences = map.ablation.at(method);
      ASSERT_EQ(by_differences.size(), std::string(method) == "pca" ? 5u : 4u) << method;
      EXPECT_LT(by_differences.at(4), by_differences.at(1)) << method;
      for (int c = 1; c <= 4; ++c) EXPECT_GT(evaluation.ablation_bytes.at(method).at(c), 0u);
    }
    EXPECT_EQ(map.ablation.at("paper").at(3), map.rmse.at("package").pooled);
    EXPECT_EQ(map.ablation.at("pca").at(4), map.rmse.at("pca4").pooled);
    EXPECT_EQ(map.ablation.at("limit").at(3), map.rmse.at("limit").pooled);
  }
  // 80 x 80 texels of 3 bytes in two maps; 6 weight maps of 10 x 10 cells.
  EXPECT_EQ(evaluation.ablation_bytes.at("paper").at(2), 2u * 3 * 80 * 80 * 3 + 6u * 100 * 2);
  EXPECT_EQ(evaluation.ablation_bytes.at("pca").at(8), 2u * 7 * 80 * 80 * 3);  // of 6 components
}

TEST_F(Evaluating, PicturesShowWhatWasCapturedAndDecoded) {
  const Package package = compress({.expressions = 6, .maps = {"albedo", "normal"}});
  EvaluateOptions options = quickOptions();
  options.pictures = PictureOptions{.map = "normal"};
  const Evaluation evaluation = evaluate(package, options);
  ASSERT_EQ(evaluation.pictures.size(), 1u);
  const ErrorPictures& pictures = evaluation.pictures.front();
  EXPECT_EQ(pictures.map, "normal");
  EXPECT_EQ(pictures.width, 80);
  EXPECT_EQ(pictures.methods, (std::vector<std::string>{"package", "pca4"}));
  EXPECT_GE(pictures.scale, evaluation.maps[1].detail.at("package").pooled.p99);
  const image::Image captured = image::readImage(folder_ / "c/normal/e02.png");
  for (std::size_t i = 0; i < captured.samples.size(); ++i) {
    ASSERT_NEAR(pictures.images[2][0][i], static_cast<float>(captured.samples[i]) / 255.0f, 1e-6);
  }
  // At this size a pixel is a texel: the errors are those of the tables.
  for (std::size_t m = 0; m < 2; ++m) {
    double squares = 0.0;
    double texels = 0.0;
    for (const float error : pictures.errors[2][m]) {
      if (error < 0.0f) continue;
      squares += static_cast<double>(error) * static_cast<double>(error);
      texels += 1.0;
    }
    EXPECT_NEAR(std::sqrt(squares / texels), evaluation.maps[1].rmse.at(pictures.methods[m]).per_expression[2], 1e-3);
    EXPECT_EQ(static_cast<std::uint64_t>(texels), evaluation.covered_texels);
  }
}

TEST_F(Evaluating, PicturesOfAllMapsInTheSizeAskedForWithoutBaselines) {
  const Package package = compress({.expressions = 2, .maps = {"albedo", "normal"}});
  EvaluateOptions options = quickOptions();
  options.pictures = PictureOptions{.all_maps = true, .paper_and_pca = false, .side = 40};
  const Evaluation evaluation = evaluate(package, options);
  ASSERT_EQ(evaluation.pictures.size(), 2u);
  EXPECT_EQ(evaluation.pictures[1].map, "normal");
  EXPECT_EQ(evaluation.pictures[1].width, 40);
  EXPECT_EQ(evaluation.pictures[1].methods, std::vector<std::string>{"package"});
}

TEST_F(Evaluating, PicturesOfLargeMapsAreAverages) {
  const Package package = compress({.expressions = 2, .width = 600, .height = 300, .channels = 1});
  EvaluateOptions options = quickOptions();
  options.pictures = PictureOptions{};
  const Evaluation evaluation = evaluate(package, options);
  EXPECT_EQ(evaluation.pictures.front().width, 256);
  EXPECT_EQ(evaluation.pictures.front().height, 128);
  EXPECT_EQ(evaluation.pictures.front().images[0][0].size(), 256u * 128 * 3);
  options.pictures->map = "roughness";
  EXPECT_THROW(evaluate(package, options), InputError);
}

TEST_F(Evaluating, ReportOfAnExactResultHasNoPsnr) {
  Evaluation evaluation;
  evaluation.expressions = {"smile"};
  Evaluation::Map map;
  map.name = "albedo";
  map.detail["package"] = {{0.0, std::numeric_limits<double>::infinity(), 0.0, 0.0}, {}};
  evaluation.maps.push_back(map);
  EXPECT_THAT(toJson(evaluation), testing::HasSubstr("\"psnr\": null"));
}

}  // namespace
}  // namespace facezip
