// The commands as users script them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <fstream>
#include <nlohmann/json.hpp>

#include "exit_codes.hpp"
#include "image/image_file.hpp"
#include "io/staged_directory.hpp"
#include "run_command.hpp"
#include "small_capture.hpp"
#include "temporary_directory.hpp"

namespace facezip {
namespace {
namespace fs = std::filesystem;
using nlohmann::json;
using test::quoted;
using test::runFacezip;
using testing::HasSubstr;

/// A compressed small capture of two maps, made once.
class Command : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new test::TemporaryDirectory;
    test::writeSmallCapture(capture(), {.expressions = 6, .maps = {"albedo", "normal"}});
    compressed_ = new test::CommandResult(
        runFacezip("compress " + quoted(capture()) + " --output " + quoted(package()) +
                   " --unit m --mask-radius 5cm --restarts 20 --report " + quoted(*folder_ / "compress.json")));
  }
  static void TearDownTestSuite() {
    delete compressed_;
    delete folder_;
  }
  static fs::path capture() { return *folder_ / "capture"; }
  static fs::path package() { return *folder_ / "package"; }
  static json readJson(const fs::path& file) { return json::parse(std::ifstream(file)); }

  static test::TemporaryDirectory* folder_;
  static test::CommandResult* compressed_;
};

test::TemporaryDirectory* Command::folder_ = nullptr;
test::CommandResult* Command::compressed_ = nullptr;

TEST_F(Command, CompressIsQuietInAPipeAndReports) {
  EXPECT_EQ(compressed_->exit_code, cli::kExitSuccess);
  EXPECT_EQ(compressed_->error, "facezip: " + (*folder_ / "capture").string() +
                                    ": no meshes of expressions: textures will change, the mesh will not move\n");
  EXPECT_THAT(compressed_->out, HasSubstr("masks"));
  const json report = readJson(*folder_ / "compress.json");
  EXPECT_EQ(report["facezip_report"], "compress");
  EXPECT_GT(report["masks"].get<int>(), 3);
  EXPECT_GT(report["seconds"]["total"].get<double>(), 0.0);
  EXPECT_EQ(report["permutation"]["restart_costs"].size(), 20u);
  EXPECT_GT(report["permutation"]["bound"].get<double>(), 0.0);
  EXPECT_LE(report["permutation"]["bound"].get<double>(), report["permutation"]["cost"].get<double>());
  EXPECT_LE(report["permutation"]["cost"].get<double>(), report["permutation"]["median_cost"].get<double>());
}

TEST_F(Command, CompressFindsATargetAndABudget) {
  const test::TemporaryDirectory out;
  const std::string command = "compress " + quoted(capture()) + " --output " + quoted(out / "p") +
                              " --unit m --mask-radius 5cm --restarts 5 --report " + quoted(out / "r.json");
  for (const char* option : {" --target-rmse 1.5", " --budget 130kB", " --target-rmse 1.5 --budget 0.2MB"}) {
    const test::CommandResult result = runFacezip(command + option);
    ASSERT_EQ(result.exit_code, 0) << result.error;
    EXPECT_THAT(result.out, HasSubstr("expected RMSE"));
    EXPECT_EQ(result.out.find("<- taken"), result.out.rfind("<- taken")) << "once";
    ASSERT_THAT(result.out, HasSubstr("<- taken"));
    const json report = readJson(out / "r.json");
    const auto taken = std::find_if(report["rate_curve"].begin(), report["rate_curve"].end(), [&](const json& point) {
      return point["differences"] == report["differences"] && point["weight_scale"] == report["weight_scale"];
    });
    ASSERT_NE(taken, report["rate_curve"].end());
    EXPECT_EQ((*taken)["code_bits"], 8);
    const bool has_target = std::string(option).find("target") != std::string::npos;
    const bool has_budget = std::string(option).find("budget") != std::string::npos;
    EXPECT_TRUE(!has_target || (*taken)["rmse"].get<double>() <= 1.5);
    EXPECT_TRUE(!has_target || report["rmse"]["albedo"].get<double>() <= 1.5 * std::sqrt(2.0)) << "of two maps";
    EXPECT_TRUE(!has_budget || (*taken)["bytes"].get<double>() <= 2e5);
  }
}

TEST_F(Command, PeakMemoryDoesNotGrowWithTheHeightOfTheImage) {
  if (FACEZIP_SANITIZED) GTEST_SKIP() << "the sanitizer keeps what is freed";
  const test::TemporaryDirectory out;
  const auto peak = [&](int height) {
    const std::string name = std::to_string(height);
    test::writeSmallCapture(out / name, {.expressions = 12, .width = 1024, .height = height});
    const test::CommandResult result =
        runFacezip("compress " + quoted(out / name) + " --output " + quoted(out / ("p" + name)) +
                   " --unit m --mask-radius 5cm --restarts 3 --memory 400MiB --report " + quoted(out / "r.json"));
    EXPECT_EQ(result.exit_code, 0) << result.error;
    return readJson(out / "r.json")["bytes"]["peak_memory"].get<double>();
  };
  // What threads hold at the same moment varies by some per cent from run to run.
  const double square = std::min(peak(1024), peak(1024));
  const double tall = std::min(peak(4096), peak(4096));
  EXPECT_LT(tall, 1.1 * square);
  EXPECT_LT(tall, 400.0 * 1048576.0);
}

TEST_F(Command, ReconstructWritesEveryMapOfTheNamedExpressions) {
  const test::TemporaryDirectory out;
  EXPECT_EQ(runFacezip("reconstruct " + quoted(package()) + " --output " + quoted(out / "r") +
                       " --expression e01 --expression e04")
                .exit_code,
            0);
  EXPECT_EQ(test::filesBelow(out / "r"), (std::set<std::string>{"albedo", "albedo/e01.png", "albedo/e04.png", "normal",
                                                                "normal/e01.png", "normal/e04.png"}));
  EXPECT_EQ(runFacezip("reconstruct " + quoted(package()) + " --output " + quoted(out / "all")).exit_code, 0);
  EXPECT_EQ(test::filesBelow(out / "all").size(), 2u + 12u);
}

TEST_F(Command, NothingIsWrittenIntoThePackageThatIsRead) {
  const std::set<std::string> before = test::filesBelow(package());
  for (const std::string& command :
       {"reconstruct " + quoted(package()) + " --output " + quoted(package() / "albedo"),
        "blend " + quoted(package()) + " --weights e02=1 --output " + quoted(package() / "{map}/neutral.png")}) {
    const test::CommandResult result = runFacezip(command);
    EXPECT_EQ(result.exit_code, cli::kExitOutput) << command;
    EXPECT_THAT(result.error, HasSubstr("the package that is read"));
  }
  EXPECT_EQ(test::filesBelow(package()), before);
}

TEST_F(Command, FormatsThatWouldLoseChannelsAreRefusedByTheNameThatWasGiven) {
  const test::TemporaryDirectory out;
  for (const char* name : {"frame.dpx", "frame.hdr", "frame.xyz"}) {
    const test::CommandResult result =
        runFacezip("blend " + quoted(package()) + " --weights e02=1 --output " + quoted(out / name));
    EXPECT_EQ(result.exit_code, cli::kExitInput) << name;
    EXPECT_THAT(result.error, HasSubstr((out / "frame.albedo").string())) << name;
  }
  EXPECT_TRUE(fs::is_empty(out.path()));
}

TEST_F(Command, BlendOfOneExpressionIsItsReconstruction) {
  const test::TemporaryDirectory out;
  ASSERT_EQ(
      runFacezip("reconstruct " + quoted(package()) + " --output " + quoted(out / "r") + " --expression e02").exit_code,
      0);
  ASSERT_EQ(
      runFacezip("blend " + quoted(package()) + " --weights e02=1 --output " + quoted(out / "frame.png")).exit_code, 0);
  EXPECT_EQ(image::readImage(out / "frame.albedo.png").samples, image::readImage(out / "r/albedo/e02.png").samples);
  EXPECT_EQ(image::readImage(out / "frame.normal.png").samples, image::readImage(out / "r/normal/e02.png").samples);
}

TEST_F(Command, BlendOfNothingIsTheNeutral) {
  const test::TemporaryDirectory out;
  ASSERT_EQ(runFacezip("blend " + quoted(package()) + " --weights e00=0 --output " + quoted(out / "{map}/frame.png"))
                .exit_code,
            0);
  EXPECT_EQ(image::readImage(out / "albedo/frame.png").samples,
            image::readImage(capture() / "albedo/neutral.png").samples);
}

TEST_F(Command, AnimationWritesAFramePerRow) {
  const test::TemporaryDirectory out;
  io::writeTextFile(out / "clip.csv", "frame,e03,e01\n0,0,0\n1,0.5,0\n2,0,1\n");
  ASSERT_EQ(runFacezip("blend " + quoted(package()) + " --animation " + quoted(out / "clip.csv") + " --output " +
                       quoted(out / "f/{map}_%04d.png"))
                .exit_code,
            0);
  EXPECT_EQ(test::filesBelow(out / "f").size(), 6u);
  EXPECT_EQ(image::readImage(out / "f/albedo_0000.png").samples,
            image::readImage(capture() / "albedo/neutral.png").samples);
  ASSERT_EQ(runFacezip("blend " + quoted(package()) + " --weights e01=1 --output " + quoted(out / "one.png")).exit_code,
            0);
  EXPECT_EQ(image::readImage(out / "f/albedo_0002.png").samples, image::readImage(out / "one.albedo.png").samples);
  EXPECT_EQ(runFacezip("blend " + quoted(package()) + " --animation " + quoted(out / "clip.csv") + " --output " +
                       quoted(out / "same.png"))
                .exit_code,
            cli::kExitInput);
}

TEST_F(Command, EvaluateReportsWhatTheSchemaSays) {
  const test::TemporaryDirectory out;
  const test::CommandResult result =
      runFacezip("evaluate " + quoted(capture()) + " " + quoted(package()) + " --report " + quoted(out / "e.json"));
  ASSERT_EQ(result.exit_code, 0) << result.error;
  EXPECT_THAT(result.out, HasSubstr("PCA(8)"));
  const json report = readJson(out / "e.json");
  for (const char* map : {"albedo", "normal"}) {
    EXPECT_GT(report["maps"][map]["rmse"]["package"].get<double>(), 0.0);
    EXPECT_GT(report["maps"][map]["rmse"]["pca4"].get<double>(), 0.0);
    for (const char* method : {"package", "pca4", "pca8", "no-permutation"}) {
      EXPECT_GE(report["maps"][map]["rmse"][method].get<double>(), 0.0);
      for (int n = 0; n < 6; ++n) {
        EXPECT_GE(report["maps"][map]["per_expression"][test::smallExpressionName(n)][method].get<double>(), 0.0);
      }
    }
  }
  // Two maps of 80 x 80 x 3 bytes: 5 textures each, and 6 weight maps of 10 x 10 x 4 bytes that the maps share.
  EXPECT_EQ(report["bytes"]["package"].get<int>(), 2 * 5 * 80 * 80 * 3 + 6 * 10 * 10 * 4);
  EXPECT_EQ(report["bytes"]["pca4"].get<int>(), 2 * 5 * 80 * 80 * 3);
  EXPECT_EQ(report["bytes"]["raw"].get<int>(), 2 * 7 * 80 * 80 * 3);
  EXPECT_GT(report["seconds"]["total"].get<double>(), 0.0);

  ASSERT_EQ(runFacezip("evaluate " + quoted(capture()) + " " + quoted(package()) + " --baselines pca4 --report " +
                       quoted(out / "f.json"))
                .exit_code,
            0);
  // The package, its own method under its name, and PCA.
  EXPECT_EQ(readJson(out / "f.json")["maps"]["albedo"]["rmse"].size(), 3u);
}

TEST_F(Command, EvaluateReportsTexelsAnglesAndBlends) {
  const test::TemporaryDirectory out;
  const test::CommandResult result =
      runFacezip("evaluate " + quoted(capture()) + " " + quoted(package()) +
                 " --baselines no-permutation,limit --blends 4 --report " + quoted(out / "e.json"));
  ASSERT_EQ(result.exit_code, 0) << result.error;
  for (const char* text : {"PSNR", "block limit", "normal: angle of normals", "4 random blends"}) {
    EXPECT_THAT(result.out, HasSubstr(text));
  }
  const json report = readJson(out / "e.json");
  const std::string method = report["method"];
  EXPECT_EQ(report["blend_weights"].size(), 4u);
  EXPECT_GT(report["maps"]["albedo"]["rmse"]["limit"].get<double>(), 0.0);
  for (const char* map : {"albedo", "normal"}) {
    const json& entry = report["maps"][map];
    EXPECT_EQ(entry["rmse"][method], entry["rmse"]["package"]);
    for (const std::string& key : {std::string("package"), method, std::string("no-permutation")}) {
      EXPECT_EQ(entry["detail"]["e01"][key]["rmse"], entry["per_expression"]["e01"][key]);
      EXPECT_GT(entry["detail_pooled"][key]["psnr"].get<double>(), 20.0);
      EXPECT_GE(entry["detail_pooled"][key]["max"].get<double>(), entry["detail_pooled"][key]["p99"].get<double>());
      EXPECT_GT(entry["blends"][key]["rmse"].get<double>(), 0.0);
      EXPECT_GT(entry["blends"][key]["largest_share_of_bound"].get<double>(), 0.0);
    }
  }
  EXPECT_GT(report["maps"]["normal"]["angle"]["package"]["mean"].get<double>(), 0.0);
  EXPECT_TRUE(report["maps"]["normal"]["angle_per_expression"]["e03"]["package"].contains("p99"));
  EXPECT_FALSE(report["maps"]["albedo"].contains("angle"));
  EXPECT_FALSE(report["maps"]["albedo"].contains("ablation"));
}

TEST_F(Command, EvaluateAblates) {
  const test::TemporaryDirectory out;
  const test::CommandResult result =
      runFacezip("evaluate " + quoted(capture()) + " " + quoted(package()) +
                 " --baselines none --blends 0 --ablation --report " + quoted(out / "e.json"));
  ASSERT_EQ(result.exit_code, 0) << result.error;
  EXPECT_THAT(result.out, HasSubstr("C = 3"));
  const json report = readJson(out / "e.json");
  for (const char* method : {"refined", "closed-loop", "paper", "no-permutation", "limit", "pca"}) {
    for (const char* differences : {"1", "2", "3", "4"}) {
      const json& entry = report["maps"]["normal"]["ablation"][method][differences];
      EXPECT_GT(entry["rmse"].get<double>(), 0.0) << method;
      EXPECT_GT(entry["bytes"].get<int>(), 0) << method;
    }
  }
  EXPECT_TRUE(report["maps"]["albedo"]["ablation"]["pca"].contains("8"));
  EXPECT_FALSE(report["maps"]["albedo"].contains("blends"));
}

TEST_F(Command, EvaluateComparesWithWeightsPerMap) {
  const test::TemporaryDirectory out;
  const test::CommandResult result =
      runFacezip("evaluate " + quoted(capture()) + " " + quoted(package()) +
                 " --baselines weights-per-map --blends 0 --report " + quoted(out / "e.json"));
  ASSERT_EQ(result.exit_code, 0) << result.error;
  EXPECT_THAT(result.out, HasSubstr("own weights"));
  const json report = readJson(out / "e.json");
  // Both maps of this capture change alike: a second set of weights costs 6 maps of 10 x 10 x 4 bytes.
  EXPECT_EQ(report["bytes"]["weights-per-map"].get<int>(), report["bytes"]["package"].get<int>() + 6 * 10 * 10 * 4);
  for (const char* map : {"albedo", "normal"}) {
    EXPECT_GT(report["maps"][map]["rmse"]["weights-per-map"].get<double>(), 0.0);
  }
}

TEST_F(Command, EvaluateDrawsThePicture) {
  const test::TemporaryDirectory out;
  const std::string command =
      "evaluate " + quoted(capture()) + " " + quoted(package()) + " --baselines pca4 --blends 0";
  const test::CommandResult result =
      runFacezip(command + " --picture " + quoted(out / "new/errors.png") + " --picture-map normal");
  ASSERT_EQ(result.exit_code, 0) << result.error;
  EXPECT_EQ(test::filesBelow(out.path()), (std::set<std::string>{"new", "new/errors.png"}));
  const image::ImageShape shape = image::readImage(out / "new/errors.png").shape;
  EXPECT_GE(shape.width, 5 * 80);  // captured, two methods and their errors
  EXPECT_GE(shape.height, 6 * 80);
  for (const std::string& bad : {std::string(" --picture ") + quoted(out / "errors.jpg"),
                                 " --picture " + quoted(out / "errors.png") + " --picture-map roughness"}) {
    EXPECT_EQ(runFacezip(command + bad).exit_code, cli::kExitInput) << bad;
  }
  for (const char* bad : {" --picture-map normal", " --blends -1", " --blends many", " --baselines pca5"}) {
    EXPECT_EQ(runFacezip(command + bad).exit_code, cli::kExitUsage) << bad;
  }
  EXPECT_EQ(runFacezip(command + " --picture /proc/facezip/errors.png").exit_code, cli::kExitOutput);
}

TEST_F(Command, ReportShowsTexturesOfATexelsHeight) {
  const test::TemporaryDirectory out;
  test::writeSmallCapture(out / "capture", {.expressions = 2, .width = 2000, .height = 3});
  ASSERT_EQ(runFacezip("compress " + quoted(out / "capture") + " -o " + quoted(out / "p") + " --unit m").exit_code, 0);
  const test::CommandResult result =
      runFacezip("report " + quoted(out / "capture") + " " + quoted(out / "p") + " -o " + quoted(out / "page.html"));
  EXPECT_EQ(result.exit_code, cli::kExitSuccess) << result.error;
}

TEST_F(Command, EndingsLeaveNothingBehind) {
  const test::TemporaryDirectory out;
  const std::string compress =
      "compress " + quoted(capture()) + " -o " + quoted(out / "p") + " --unit m --mask-radius 5cm --restarts ";
  for (const char* ending : {"INT", "TERM", "HUP"}) {
    // The search takes minutes; on a busy machine it takes a second until signals are heard.
    const test::CommandResult result =
        runFacezip(compress + "10000000", "timeout --preserve-status -s " + std::string(ending) + " 3");
    EXPECT_EQ(result.exit_code, cli::kExitCancelled) << ending << ": " << result.error;
    EXPECT_TRUE(fs::is_empty(out.path())) << ending;
  }
  // A file that may not grow: 8 blocks of 512 bytes.
  const test::CommandResult result = runFacezip(compress + "3", "sh -c 'ulimit -f 8; exec \"$0\" \"$@\"'");
  EXPECT_EQ(result.exit_code, cli::kExitOutput) << result.error;
  EXPECT_TRUE(fs::is_empty(out.path()));
}

TEST_F(Command, ViewEndsWheneverItIsAskedTo) {
  for (int milliseconds = 2; milliseconds <= 24; milliseconds += 2) {
    const test::CommandResult result = runFacezip(
        "view " + quoted(package()) + " --port 0",
        "timeout --kill-after=60 0.0" + std::string(milliseconds < 10 ? "0" : "") + std::to_string(milliseconds));
    EXPECT_EQ(result.exit_code, 124) << "killed when asked after " << milliseconds << " ms";
  }
}

TEST_F(Command, InfoDevicesVersionAndHelp) {
  const std::string info = runFacezip("info " + quoted(package())).out;
  EXPECT_THAT(info, HasSubstr("6 expressions, 4 difference textures"));
  EXPECT_THAT(info, HasSubstr("3 channels, 8-bit, differences in 8 bits, 8 texels to a weight texel"));
  EXPECT_THAT(info, HasSubstr("  weights: "));
  // The same with a second set: sets are known by the maps that use them.
  const test::TemporaryDirectory folder;
  fs::copy(package(), folder / "package", fs::copy_options::recursive);
  json description = readJson(package() / "package.json");
  description["weights"].push_back(description["weights"][0]);
  description["maps"][1]["weights"] = 1;
  std::ofstream(folder / "package/package.json") << description;
  const std::string sets = runFacezip("info " + quoted(folder / "package")).out;
  EXPECT_THAT(sets, HasSubstr("  weights of albedo: "));
  EXPECT_THAT(sets, HasSubstr("  weights of normal: "));
  EXPECT_THAT(runFacezip("devices").out, HasSubstr("0:0"));
  EXPECT_THAT(runFacezip("--version").out, HasSubstr("facezip "));
  for (const char* command :
       {"synth", "compress", "reconstruct", "blend", "evaluate", "convert", "info", "devices", "demo"}) {
    const test::CommandResult help = runFacezip(std::string(command) + " --help");
    EXPECT_EQ(help.exit_code, 0) << command;
    EXPECT_THAT(help.out, HasSubstr("--help")) << command;
  }
}

TEST_F(Command, ConvertSaysWhatItGainsAndWhatItCosts) {
  const test::TemporaryDirectory out;
  const std::string convert = "convert " + quoted(package()) + " --output " + quoted(out / "blocks");
  const test::CommandResult result = runFacezip(
      convert + " --texture-format astc-5x5 --difference-format astc-6x6 --report " + quoted(out / "r.json"));
  ASSERT_EQ(result.exit_code, 0) << result.error;
  EXPECT_EQ(result.error, "");
  EXPECT_THAT(result.out, HasSubstr("astc-5x5, differences astc-6x6"));
  EXPECT_THAT(result.out, HasSubstr("RMSE to before"));
  const json report = readJson(out / "r.json");
  EXPECT_EQ(report["facezip_report"], "convert");
  EXPECT_EQ(report["maps"]["normal"]["difference_format"], "astc-6x6");
  EXPECT_GT(report["maps"]["albedo"]["rmse"].get<double>(), 0.0);
  EXPECT_LT(report["bytes"]["memory"]["after"].get<int>(), report["bytes"]["memory"]["before"].get<int>());
  EXPECT_THAT(
      runFacezip("info " + quoted(out / "blocks")).out,
      testing::AllOf(HasSubstr("neutral in astc-5x5 blocks"),
                     HasSubstr("albedo/difference_3.ktx2: astc-6x6, 6 x 6 texels in 16 bytes, 0.00 MB without mip")));

  EXPECT_EQ(runFacezip(convert).exit_code, cli::kExitUsage) << "no format";
  for (const char* format : {"bc9", "bc", "astc", "png --difference-format bc7", "bc5", "png"}) {
    const test::CommandResult refused = runFacezip("convert " + quoted(package()) + " --output " +
                                                   quoted(out / "refused") + " --texture-format " + format);
    EXPECT_EQ(refused.exit_code, cli::kExitInput) << format;
    EXPECT_FALSE(fs::exists(out / "refused")) << format;
  }
}

TEST_F(Command, DemoMakesEverything) {
  const test::TemporaryDirectory out;
  const test::CommandResult result = runFacezip("demo --resolution 128 --output " + quoted(out / "demo"));
  ASSERT_EQ(result.exit_code, 0) << result.error;
  EXPECT_THAT(result.out, HasSubstr("PCA(4)"));
  for (const char* file :
       {"capture/capture.json", "package/package.json", "compress.json", "evaluate.json", "contact_sheet.png"}) {
    EXPECT_TRUE(fs::exists(out / "demo" / file)) << file;
  }
}

TEST_F(Command, InterruptLeavesNothing) {
  const test::TemporaryDirectory out;
  const test::CommandResult result =
      runFacezip("synth --resolution 4096 --output " + quoted(out / "capture"), "timeout --signal=INT 3");
  EXPECT_EQ(test::filesBelow(out.path()).size(), 0u);
  EXPECT_THAT(result.error, HasSubstr("cancelled"));
}

}  // namespace
}  // namespace facezip
