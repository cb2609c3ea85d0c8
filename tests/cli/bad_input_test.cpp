// Every bad input: one clear error with file, item, expected, got and cure, the right exit code, nothing left behind.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <limits>

#include "exit_codes.hpp"
#include "facezip/geometry/obj_io.hpp"
#include "file_contents.hpp"
#include "io/staged_directory.hpp"
#include "run_command.hpp"
#include "small_capture.hpp"
#include "temporary_directory.hpp"

namespace facezip {
namespace {
namespace fs = std::filesystem;
using test::quoted;
using test::runFacezip;
using testing::HasSubstr;

constexpr const char* kOptions = " --unit m --mask-radius 5cm --restarts 3 --cluster-restarts 3";

/// A capture to break, and a place for the package.
class BadInput : public testing::Test {
 protected:
  void SetUp() override { test::writeSmallCapture(capture(), {.expressions = 3, .width = 48, .height = 48}); }

  fs::path capture() const { return folder_ / "capture"; }
  fs::path package() const { return folder_ / "package"; }

  test::CommandResult compress(const std::string& options = kOptions, const std::string& before = "") const {
    return runFacezip("compress " + quoted(capture()) + " --output " + quoted(package()) + " " + options, before);
  }

  /// Compressing fails with `exit_code`, the message holds each of `parts` and nothing is left.
  void expectFailure(int exit_code, const std::vector<std::string>& parts, const std::string& options = kOptions,
                     const std::string& before = "") const {
    const auto files = test::filesBelow(folder_.path());
    const test::CommandResult result = compress(options, before);
    EXPECT_EQ(result.exit_code, exit_code) << result.error;
    for (const std::string& part : parts) EXPECT_THAT(result.error, HasSubstr(part));
    // Image libraries may write lines of their own before; ours is the last, and one.
    const std::size_t ours = result.error.find("facezip: error: ");
    ASSERT_NE(ours, std::string::npos) << result.error;
    EXPECT_EQ(result.error.find('\n', ours), result.error.size() - 1) << "one line:\n" << result.error;
    EXPECT_EQ(result.out, "");
    EXPECT_EQ(test::filesBelow(folder_.path()), files) << "something was left behind";
  }

  void writeTexture(const std::string& name, const image::ImageShape& shape) const {
    image::writeImage(capture() / "albedo" / name, test::makeImage(shape, [](int, int, int) { return 9.0; }));
  }

  const test::TemporaryDirectory folder_;
};

TEST_F(BadInput, MemoryThatAWindowOfTheWeightsWouldExceed) {
  expectFailure(cli::kExitInput, {"--memory", "at least", "--weight-scale of 4, 8, 16 or 32"},
                std::string(kOptions) + " --weight-scale 63 --memory 260MiB");
}

TEST_F(BadInput, NothingThatIsNotAPackageIsReplaced) {
  fs::create_directories(package() / "src");
  io::writeTextFile(package() / "package.json", "{\"name\": \"a web page\"}");
  io::writeTextFile(package() / "src/app.js", "precious");
  expectFailure(cli::kExitOutput, {"no package.json of facezip's", "--output"});
  fs::remove_all(package());
  ASSERT_EQ(compress().exit_code, cli::kExitSuccess);
  fs::rename(capture(), package() / "capture");
  const test::CommandResult result =
      runFacezip("compress " + quoted(package() / "capture") + " -o " + quoted(package()) + kOptions);
  EXPECT_EQ(result.exit_code, cli::kExitOutput);
  EXPECT_THAT(result.error, HasSubstr("the capture that is read, lies in it"));
  EXPECT_TRUE(fs::exists(package() / "capture/neutral.obj"));
}

TEST_F(BadInput, ReconstructReplacesNoCapturedTextures) {
  ASSERT_EQ(compress().exit_code, cli::kExitSuccess);
  for (const fs::path& output : {capture(), package()}) {
    const auto files = test::filesOf(folder_.path());
    const test::CommandResult result = runFacezip("reconstruct " + quoted(package()) + " --output " + quoted(output));
    EXPECT_EQ(result.exit_code, cli::kExitOutput);
    EXPECT_THAT(result.error, HasSubstr("not to be replaced"));
    EXPECT_EQ(test::filesOf(folder_.path()), files);
  }
}

TEST_F(BadInput, AReportThatCannotBeWrittenIsRefusedBeforeTheWork) {
  io::writeTextFile(folder_ / "file", "no folder");
  for (const fs::path& report : {folder_ / "file/r.json", folder_.path()}) {
    expectFailure(cli::kExitOutput, {"cannot write", "--report"},
                  std::string(kOptions) + " --report " + quoted(report));
  }
}

TEST_F(BadInput, GoodInputIsTaken) { EXPECT_EQ(compress().exit_code, cli::kExitSuccess); }

TEST_F(BadInput, MissingNeutralTexture) {
  fs::remove(capture() / "albedo/neutral.png");
  expectFailure(cli::kExitInput, {"albedo/neutral.png", "no such file"});
}

TEST_F(BadInput, MissingNeutralMesh) {
  fs::remove(capture() / "neutral.obj");
  expectFailure(cli::kExitInput, {"neutral.obj", "no such file"});
}

TEST_F(BadInput, TextureOfAnotherSize) {
  writeTexture("e01.png", {32, 48, 3, image::SampleType::kUint8});
  expectFailure(cli::kExitInput, {"e01.png", "48 x 48", "32 x 48", "resize"});
}

TEST_F(BadInput, TextureOfAnotherChannelCount) {
  writeTexture("e01.png", {48, 48, 1, image::SampleType::kUint8});
  expectFailure(cli::kExitInput, {"e01.png", "3 channels", "1 channel,"});
}

TEST_F(BadInput, UnreadableTexture) {
  io::writeTextFile(capture() / "albedo/e01.png", "not a picture");
  expectFailure(cli::kExitInput, {"e01.png"});
}

TEST_F(BadInput, TruncatedTexture) {
  fs::resize_file(capture() / "albedo/e02.png", fs::file_size(capture() / "albedo/e02.png") / 2);
  expectFailure(cli::kExitInput, {"e02.png", "truncated"});
  EXPECT_THAT(compress().error, testing::Not(HasSubstr("libpng")));
}

TEST_F(BadInput, NaNInAFloatTexture) {
  fs::remove_all(capture());
  test::writeSmallCapture(
      capture(),
      {.expressions = 2, .width = 48, .height = 48, .type = image::SampleType::kFloat32, .extension = "exr"});
  image::Image image = image::readImage(capture() / "albedo/e01.exr");
  reinterpret_cast<float*>(image.samples.data())[(30 * 48 + 7) * 3] = std::numeric_limits<float>::quiet_NaN();
  image::writeImage(capture() / "albedo/e01.exr", image);
  expectFailure(cli::kExitInput, {"e01.exr", "row 30, column 7", "NaN"});
}

TEST_F(BadInput, MeshOfAnotherTopology) {
  fs::create_directory(capture() / "expressions");
  geometry::writeObj(capture() / "expressions/e01.obj", test::gridMesh(20));
  expectFailure(cli::kExitInput, {"e01.obj", "441", "400"});
}

TEST_F(BadInput, MeshThatMatchesNoExpressionIsNoted) {
  fs::create_directory(capture() / "expressions");
  for (const char* name : {"E00.obj", "e01.OBJ"}) {
    fs::copy_file(capture() / "neutral.obj", capture() / "expressions" / name);
  }
  const test::CommandResult result = compress();
  EXPECT_EQ(result.exit_code, cli::kExitSuccess) << result.error;
  EXPECT_THAT(result.error, HasSubstr("E00.obj matches no expression; no mesh for e00, e02"));
}

TEST_F(BadInput, MeshWithoutUvs) {
  geometry::TriangleMesh mesh = test::gridMesh(21);
  mesh.uvs.resize(0, 2);
  mesh.uv_triangles.resize(0, 3);
  geometry::writeObj(capture() / "neutral.obj", mesh);
  expectFailure(cli::kExitInput, {"neutral.obj", "UV"});
}

TEST_F(BadInput, UvsOutsideTheImage) {
  geometry::TriangleMesh mesh = test::gridMesh(21);
  mesh.uvs(17, 0) = 1.25;
  geometry::writeObj(capture() / "neutral.obj", mesh);
  expectFailure(cli::kExitInput, {"neutral.obj", "1.25", "from 0 to 1"});
}

TEST_F(BadInput, MeshThatIsNoMesh) {
  io::writeTextFile(capture() / "neutral.obj", "v 0 0\nf 1 2 3\n");
  expectFailure(cli::kExitInput, {"neutral.obj"});
}

TEST_F(BadInput, EmptyRegion) {
  io::writeTextFile(capture() / "face_region.txt", "# nothing\n");
  expectFailure(cli::kExitInput, {"face_region.txt"});
  fs::remove(capture() / "face_region.txt");
  image::writeImage(capture() / "coverage.png",
                    test::makeImage({16, 16, 1, image::SampleType::kUint8}, [](int, int, int) { return 0.0; }));
  expectFailure(cli::kExitInput, {"coverage.png", "empty region"});
  // Black and opaque.
  image::writeImage(capture() / "coverage.png",
                    test::makeImage({16, 16, 2, image::SampleType::kUint8}, [](int, int, int c) { return 255.0 * c; }));
  expectFailure(cli::kExitInput, {"coverage.png", "empty region"});
}

TEST_F(BadInput, RegionWithAWrongIndex) {
  io::writeTextFile(capture() / "face_region.txt", "0\n1\n99999\n");
  expectFailure(cli::kExitInput, {"face_region.txt", "99999", "3"});
  for (const char* index : {"4294967296", "1.0", "1x", "0x1", "-1", "1,2", "1e1"}) {
    io::writeTextFile(capture() / "face_region.txt", std::string("0\n") + index + "\n");
    expectFailure(cli::kExitInput, {"face_region.txt", "line 2", index});
  }
}

TEST_F(BadInput, ImportanceThatCannotBeUsed) {
  const std::string option = std::string(kOptions) + " --importance ";
  expectFailure(cli::kExitInput, {"absent.png", "no such file"}, option + quoted(folder_ / "absent.png"));
  io::writeTextFile(folder_ / "text.png", "not a picture");
  expectFailure(cli::kExitInput, {"text.png", "an image"}, option + quoted(folder_ / "text.png"));
  const auto black = test::makeImage({8, 8, 1, image::SampleType::kUint8}, [](int, int, int) { return 0.0; });
  image::writeImage(folder_ / "black.png", black);
  expectFailure(cli::kExitInput, {"black.png", "not black everywhere", "white"},
                option + quoted(folder_ / "black.png"));
  // The same of the capture's own, unless it is put aside.
  io::writeTextFile(capture() / "capture.json", R"({"importance": "gone.png"})");
  expectFailure(cli::kExitInput, {"gone.png", "no such file"});
  image::writeImage(capture() / "gone.png", black);
  expectFailure(cli::kExitInput, {"gone.png", "not black everywhere"});
  EXPECT_EQ(compress(option + "none").exit_code, cli::kExitSuccess);
}

TEST_F(BadInput, TargetOrBudgetThatCannotBeMet) {
  const std::string options = kOptions;
  // 48 x 48 texels of 3 bytes, neutral and one difference; 2 x 2 cells of 3 expressions.
  expectFailure(cli::kExitInput, {"--budget", "at least 13836 bytes", "got 13000"}, options + " --budget 13kB");
  expectFailure(cli::kExitInput, {"--budget", "a size such as", "lots"}, options + " --budget lots");
  expectFailure(cli::kExitInput, {"--target-rmse", "at least 0.", "got 0.001"}, options + " --target-rmse 0.001");
  for (const char* value : {"0", "-1", "nan", "inf"}) {
    expectFailure(cli::kExitInput, {"--target-rmse", "above 0", value}, options + " --target-rmse " + value);
  }
  expectFailure(cli::kExitInput, {"--method", "refined", "got paper"}, options + " --budget 1MB --method paper");
}

TEST_F(BadInput, FewerSamplesThanAskedFor) { expectFailure(cli::kExitInput, {"1000", "441"}, "--unit m --masks 1000"); }

TEST_F(BadInput, RadiusLargerThanTheFace) { expectFailure(cli::kExitInput, {"radius"}, "--unit m --mask-radius 2m"); }

TEST_F(BadInput, NoExpression) {
  for (int n = 0; n < 3; ++n) fs::remove(capture() / "albedo" / (test::smallExpressionName(n) + ".png"));
  expectFailure(cli::kExitInput, {"at least one expression"});
}

TEST_F(BadInput, OneExpressionIsTakenAndSaid) {
  for (int n = 1; n < 3; ++n) fs::remove(capture() / "albedo" / (test::smallExpressionName(n) + ".png"));
  const test::CommandResult result = compress();
  EXPECT_EQ(result.exit_code, cli::kExitSuccess);
  EXPECT_THAT(result.error, HasSubstr("1 expression: each gets a difference texture of its own"));
}

TEST_F(BadInput, TwoExpressionsWithTheSameName) {
  io::writeTextFile(capture() / "capture.json", R"({"expressions": ["e00", "e01", "e00"]})");
  expectFailure(cli::kExitInput, {"capture.json", "e00", "twice"});
}

TEST_F(BadInput, DescriptionThatAPackageCannotHold) {
  for (const char* field : {R"("weight": 1e999)", R"("weight": 2e9)", R"("colour_space": "srgb")"}) {
    io::writeTextFile(capture() / "capture.json", std::string(R"({"maps": {"albedo": {)") + field + "}}}");
    expectFailure(cli::kExitInput, {(capture() / "capture.json").string(), "expected", "see docs/capture_format.md"});
  }
}

TEST_F(BadInput, UnitThatCannotBeGuessed) {
  geometry::TriangleMesh mesh = test::gridMesh(21);
  mesh.positions *= 7.0;  // 1.4 m wide, or 1.4 of anything else
  geometry::writeObj(capture() / "neutral.obj", mesh);
  expectFailure(cli::kExitInput, {"neutral.obj", "--unit"}, "");
}

// Where nothing asks for the unit but the size of the mesh that is written.
TEST_F(BadInput, UnitThatIsGuessedOrNotIsSaidWithANumberOfMasksToo) {
  geometry::TriangleMesh mesh = test::gridMesh(21);
  mesh.positions.col(2) *= 8.0;  // as deep as a head
  geometry::writeObj(capture() / "neutral.obj", mesh);
  const test::CommandResult guessed = compress("--masks 6");
  EXPECT_EQ(guessed.exit_code, cli::kExitSuccess) << guessed.error;
  EXPECT_THAT(guessed.error, HasSubstr("its unit is taken to be m"));
  mesh.positions *= 9.0;
  geometry::writeObj(capture() / "neutral.obj", mesh);
  const test::CommandResult unknown = compress("--masks 6");
  EXPECT_EQ(unknown.exit_code, cli::kExitSuccess) << unknown.error;
  EXPECT_THAT(unknown.error,
              testing::AllOf(HasSubstr("tells no unit"), HasSubstr("as if in metres"), HasSubstr("--unit")));
  EXPECT_THAT(compress("--masks 6 --no-mesh").error, testing::Not(HasSubstr("unit")));
  EXPECT_THAT(compress("--masks 6 --unit m").error, testing::Not(HasSubstr("metres")));
}

TEST_F(BadInput, UnknownUnitLengthAndSize) {
  expectFailure(cli::kExitInput, {"furlong"}, "--unit furlong");
  expectFailure(cli::kExitInput, {"3parsec"}, "--unit m --mask-radius 3parsec");
  expectFailure(cli::kExitInput, {"--memory", "lots"}, "--unit m --memory lots");
  expectFailure(cli::kExitInput, {"--memory", "10 MiB"}, "--unit m --mask-radius 5cm --memory 10MiB");
}

TEST_F(BadInput, NumbersOutOfRange) {
  for (const char* value : {"-1", "99999999999999999999", "1.5", "one"}) {
    expectFailure(cli::kExitInput, {"--seed: expected a whole number from 0", value}, std::string("--seed ") + value);
  }
  expectFailure(cli::kExitInput, {"--masks: expected at least 1, got 0"}, "--unit m --masks 0");
  // Whole or refused; 010 is ten, not eight.
  for (const char* value : {"0x10", "true", "1.5", "'3 '", "1e1", "9999999999", "''"}) {
    EXPECT_EQ(compress(std::string("--unit m --masks ") + value).exit_code, cli::kExitUsage) << value;
  }
  EXPECT_THAT(compress("--unit m --masks 08").out, HasSubstr("8 masks"));
  for (const char* value : {"0x1p-4", "0.01x", "one"}) {
    EXPECT_EQ(compress(std::string("--unit m --mask-cutoff ") + value).exit_code, cli::kExitUsage) << value;
  }
  for (const char* value : {"3cm5", "3,5cm", "0x3cm", "3cm cm", "cm", "-3cm", "infcm"}) {
    expectFailure(cli::kExitInput, {"--mask-radius", value}, std::string("--unit m --mask-radius '") + value + "'");
  }
  expectFailure(cli::kExitInput, {"--region", "UTF-8"}, "--unit m --region r\xff.txt");
  for (const char* value : {"-1", "2147483647"}) {
    expectFailure(cli::kExitInput, {"--gutter: expected 0 to 1024, got ", value},
                  std::string("--unit m --gutter ") + value);
  }
  const test::CommandResult synth = runFacezip("synth --seed -1 --output " + quoted(folder_ / "s"));
  EXPECT_EQ(synth.exit_code, cli::kExitInput);
  EXPECT_THAT(synth.error, HasSubstr("--seed"));
  EXPECT_EQ(runFacezip("demo --seed -1 --output " + quoted(folder_ / "s")).exit_code, cli::kExitInput);
  const test::CommandResult sweep = runFacezip("report a b --output c.html --mask-sweep 8,0");
  EXPECT_EQ(sweep.exit_code, cli::kExitInput);
  EXPECT_THAT(sweep.error, HasSubstr("--mask-sweep: expected numbers of at least 1, got 0"));
}

TEST_F(BadInput, OutputsWithoutAName) {
  ASSERT_EQ(compress().exit_code, cli::kExitSuccess);
  const std::string face = quoted(package());
  for (const std::string& command :
       {"compress " + quoted(capture()) + kOptions, std::string("synth --resolution 64"), std::string("demo"),
        "reconstruct " + face, "blend " + face + " --weights e00=1", "export " + face + " --target gltf",
        "view " + face, "report " + quoted(capture()) + " " + face}) {
    const test::CommandResult result = runFacezip(command + " --output ''");
    EXPECT_EQ(result.exit_code, cli::kExitInput) << command << ": " << result.error;
    EXPECT_THAT(result.error, HasSubstr("--output: expected a")) << command;
  }
}

TEST_F(BadInput, NoOpenClDevice) {
  fs::create_directory(folder_ / "no-drivers");
  expectFailure(cli::kExitDevice, {"no OpenCL device found", "install"}, kOptions,
                "OCL_ICD_VENDORS=" + quoted(folder_ / "no-drivers") + "/");
}

TEST_F(BadInput, UnknownDevice) {
  EXPECT_EQ(compress(std::string(kOptions) + " --device toaster").exit_code, cli::kExitDevice);
}

TEST_F(BadInput, DeviceWithoutMemoryForABand) {
  if (FACEZIP_SANITIZED) GTEST_SKIP() << "oclgrind preloads itself, and the sanitizer must come first";
  const std::string simulator = FACEZIP_OCLGRIND;
  if (simulator.empty() || simulator.find("NOTFOUND") != std::string::npos) {
    GTEST_SKIP() << "needs oclgrind, whose device can be given little memory";
  }
  fs::remove_all(capture());
  test::writeSmallCapture(capture(), {.expressions = 20, .width = 4096, .height = 16});
  expectFailure(cli::kExitDevice, {"band of 16 rows", "--device"}, std::string(kOptions) + " --device oclgrind",
                quoted(fs::path(simulator)) + " --global-mem-size 16777216");
}

TEST_F(BadInput, OutputThatCannotBeWritten) {
  const test::CommandResult result =
      runFacezip("compress " + quoted(capture()) + " --output /proc/facezip/package" + kOptions);
  EXPECT_EQ(result.exit_code, cli::kExitOutput) << result.error;
  EXPECT_THAT(result.error, HasSubstr("/proc/facezip"));
}

TEST_F(BadInput, OutputThatIsSomethingElse) {
  fs::create_directory(package());
  io::writeTextFile(package() / "holiday.txt", "precious");
  expectFailure(cli::kExitOutput, {"package", "not empty"});
}

TEST_F(BadInput, CommandLine) {
  EXPECT_EQ(runFacezip("").exit_code, cli::kExitUsage);
  EXPECT_EQ(runFacezip("squeeze").exit_code, cli::kExitUsage);
  EXPECT_EQ(runFacezip("compress").exit_code, cli::kExitUsage);
  EXPECT_EQ(compress("--masks 5 --mask-radius 3cm").exit_code, cli::kExitUsage);
  EXPECT_EQ(compress("--method magic").exit_code, cli::kExitUsage);
  for (const char* chosen : {"--target-rmse 2", "--budget 1MB"}) {
    for (const char* given : {" --differences 4", " --weight-scale 8"}) {
      EXPECT_EQ(compress(std::string(chosen) + given).exit_code, cli::kExitUsage) << chosen << given;
    }
  }
  EXPECT_EQ(compress("--target-rmse little").exit_code, cli::kExitUsage);
}

/// A package to break: every file damaged in every way is refused by every command that reads it.
TEST_F(BadInput, DamagedPackages) {
  ASSERT_EQ(compress().exit_code, cli::kExitSuccess);
  const fs::path good = folder_ / "good";
  fs::rename(package(), good);
  const std::vector<std::function<void(const fs::path&)>> damages = {
      [](const fs::path& file) { fs::remove(file); }, [](const fs::path& file) { fs::resize_file(file, 0); },
      [](const fs::path& file) { fs::resize_file(file, fs::file_size(file) / 2); },
      [](const fs::path& file) { io::writeTextFile(file, "something else"); }};
  for (const char* file : {"package.json", "weights.png", "albedo/neutral.png", "albedo/difference_2.png"}) {
    for (std::size_t d = 0; d < damages.size(); ++d) {
      fs::remove_all(package());
      fs::copy(good, package(), fs::copy_options::recursive);
      damages[d](package() / file);
      const test::CommandResult result =
          runFacezip("reconstruct " + quoted(package()) + " --output " + quoted(folder_ / "out"));
      EXPECT_EQ(result.exit_code, cli::kExitInput) << file << ", damage " << d << ": " << result.error;
      EXPECT_THAT(result.error, HasSubstr(fs::path(file).filename().string())) << "damage " << d;
      EXPECT_FALSE(fs::exists(folder_ / "out"));
    }
  }
}

/// Damage that leaves the length of an image as it was, where a command that decodes nothing might miss it.
TEST_F(BadInput, PackagesWhoseImagesCannotBeDecoded) {
  ASSERT_EQ(compress().exit_code, cli::kExitSuccess);
  std::string image = test::contentsOf(package() / "albedo/difference_1.png");
  image[image.find("IDAT") + 8] ^= 0x10;
  io::writeTextFile(package() / "albedo/difference_1.png", image);
  for (const char* command : {"info ", "export --target gltf --output out ", "view --output out ",
                              "convert --texture-format bc7 --output out "}) {
    const test::CommandResult result = runFacezip(command + quoted(package()), "cd " + quoted(folder_.path()) + " &&");
    EXPECT_EQ(result.exit_code, cli::kExitInput) << command;
    EXPECT_THAT(result.error, HasSubstr("albedo/difference_1.png")) << command;
    EXPECT_EQ(result.out, "") << command;
    EXPECT_FALSE(fs::exists(folder_ / "out")) << command;
  }
}

TEST_F(BadInput, ReportOfACompressionThatIsNone) {
  ASSERT_EQ(compress().exit_code, cli::kExitSuccess);
  const fs::path page = folder_ / "page.html";
  io::writeTextFile(folder_ / "list.json", "[]");
  io::writeTextFile(folder_ / "text.json", "{ not json");
  io::writeTextFile(folder_ / "deep.json", "{\"facezip_report\": \"compress\", \"stages\": " +
                                               std::string(300000, '[') + std::string(300000, ']') + "}");
  for (const auto& [file, got] :
       {std::pair("none.json", "no such file"), std::pair("list.json", "something else"),
        std::pair("text.json", "parse error"), std::pair("deep.json", "nested"), std::pair("capture", "a folder")}) {
    const test::CommandResult result =
        runFacezip("report " + quoted(capture()) + " " + quoted(package()) + " --output " + quoted(page) +
                   " --compress-report " + quoted(folder_ / file));
    EXPECT_EQ(result.exit_code, cli::kExitInput) << file;
    EXPECT_THAT(result.error, HasSubstr((folder_ / file).string()));
    EXPECT_THAT(result.error, HasSubstr(got));
    EXPECT_FALSE(fs::exists(page));
  }
}

TEST_F(BadInput, UnknownExpressionNamesTheNearest) {
  ASSERT_EQ(compress().exit_code, cli::kExitSuccess);
  const test::CommandResult result =
      runFacezip("blend " + quoted(package()) + " --weights E02x=1 --output " + quoted(folder_ / "frame.png"));
  EXPECT_EQ(result.exit_code, cli::kExitInput);
  EXPECT_THAT(result.error, HasSubstr("e02"));
  EXPECT_FALSE(fs::exists(folder_ / "frame.png"));
}

}  // namespace
}  // namespace facezip
