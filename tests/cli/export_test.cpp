// `facezip export` as users script it: what lies in the folder for each target, and what is refused.
#include "facezip/export.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "exit_codes.hpp"
#include "facezip/view.hpp"
#include "file_contents.hpp"
#include "io/staged_directory.hpp"
#include "run_command.hpp"
#include "small_capture.hpp"
#include "temporary_directory.hpp"

namespace facezip {
namespace {
namespace fs = std::filesystem;
using test::contentsOf;
using test::quoted;
using test::runFacezip;
using testing::HasSubstr;
using testing::IsSupersetOf;

class Export : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new test::TemporaryDirectory;
    compress("face", {.expressions = 6, .maps = {"albedo", "normal"}});
    compress("bare", {.expressions = 6}, " --no-mesh");
    compress("crowd", {.expressions = 100, .width = 40, .height = 40}, " --differences 5");
    compress("floats", {.expressions = 5, .type = image::SampleType::kFloat32, .extension = "exr"});
    compress("deep", {.expressions = 5, .type = image::SampleType::kUint16});
    compress("bc7", {.expressions = 5}, " --texture-format bc7");
    compress("odd", {.expressions = 5, .width = 78}, " --texture-format bc7");
    compress("astc", {.expressions = 5}, " --texture-format astc-6x6 --difference-format astc-8x5");
  }
  static void TearDownTestSuite() { delete folder_; }

  static void compress(const std::string& name, const test::SmallCaptureOptions& options,
                       const std::string& more = "") {
    test::writeSmallCapture(folder() / (name + "_capture"), options);
    const test::CommandResult result =
        runFacezip("compress " + quoted(folder() / (name + "_capture")) + " --output " + quoted(folder() / name) +
                   " --unit m --mask-radius 5cm --restarts 3" + more);
    ASSERT_EQ(result.exit_code, 0) << result.error;
  }
  static test::CommandResult exportTo(const std::string& package, const std::string& target, const fs::path& output) {
    return runFacezip("export " + quoted(folder() / package) + " --target " + target + " --output " + quoted(output));
  }
  static fs::path folder() { return folder_->path(); }
  static std::set<std::string> namesIn(const fs::path& folder) {
    std::set<std::string> names;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
      if (entry.is_regular_file()) names.insert(entry.path().lexically_relative(folder).string());
    }
    return names;
  }

  static test::TemporaryDirectory* folder_;
};

test::TemporaryDirectory* Export::folder_ = nullptr;

const std::map<std::string, std::vector<std::string>> kFiles = {
    {"gltf", {"facezip_blend.h", "package/package.json"}},
    {"three", {"facezip_three.js", "package/mesh.glb", "package/weights.png"}},
    {"blender", {"facezip_blender.py", "package/normal/difference_3.png"}},
    {"godot",
     {"project.godot", "face.tscn", "face.shader", "face.material.tres", "facezip_face.gd", "demo.tscn", "demo.gd",
      "scene.gltf.import", "textures/albedo_neutral.png.import", "textures/normal_differences.png.import",
      "textures/weights_0_0.png"}},
    {"unity",
     {"FaceZip.shader", "FaceZip.hlsl", "FaceZip.json", "FaceZipDriver.cs", "FaceZipImport.cs",
      "textures/albedo_difference_3.png", "textures/normal_neutral.png", "textures/weights_0_0.png"}},
    {"unreal",
     {"facezip_unreal.py", "FaceZip.ush", "FaceZip.json", "node_albedo.hlsl", "node_normal.hlsl",
      "textures/albedo_difference_3.png", "textures/weights_0_0.png"}}};

TEST_F(Export, EveryTargetBringsWhatItsReadmeSpeaksOf) {
  for (const auto& [target, files] : kFiles) {
    const fs::path out = folder() / ("to_" + target);
    const test::CommandResult result = exportTo("face", target, out);
    ASSERT_EQ(result.exit_code, 0) << target << ": " << result.error;
    const std::set<std::string> names = namesIn(out);
    EXPECT_THAT(names, IsSupersetOf({std::string("scene.gltf"), std::string("scene.bin"), std::string("README.md")}));
    EXPECT_THAT(names, IsSupersetOf(files)) << target;
    for (const std::string& name : names) {
      if (name.ends_with(".png")) continue;
      EXPECT_THAT(contentsOf(out / name), testing::Not(HasSubstr("@NAME@"))) << name;
    }
    EXPECT_EQ(exportTo("face", target, out).exit_code, 0) << "replaced";
    EXPECT_EQ(namesIn(out), names);
  }
  EXPECT_THAT(contentsOf(folder() / "to_unity/FaceZip.shader"),
              HasSubstr("albedo_difference_3 (\"albedo_difference_3\", 2D)"));
  EXPECT_THAT(contentsOf(folder() / "to_godot/face.tscn"), HasSubstr("PoolStringArray( \"e00\""));
}

TEST_F(Export, HelpNamesEveryTarget) {
  const test::CommandResult result = runFacezip("export --help");
  for (const auto& [target, files] : kFiles) EXPECT_THAT(result.out, HasSubstr(target));
}

TEST_F(Export, WithoutNormalsAndWithAHundredExpressions) {
  for (const auto& [target, files] : kFiles) {
    const fs::path out = folder() / ("crowd_" + target);
    const test::CommandResult result = exportTo("crowd", target, out);
    ASSERT_EQ(result.exit_code, 0) << target << ": " << result.error;
  }
  EXPECT_THAT(contentsOf(folder() / "crowd_unity/FaceZip.hlsl"), HasSubstr("float fz_beta[100]"));
  EXPECT_THAT(contentsOf(folder() / "crowd_unreal/node_albedo.hlsl"), HasSubstr("face.fz_beta[99] = beta_99;"));
  EXPECT_THAT(contentsOf(folder() / "crowd_godot/face.shader"), testing::Not(HasSubstr("NORMALMAP")));
  EXPECT_TRUE(fs::exists(folder() / "crowd_godot/textures/weights_0_1.png")) << "C = 5";
}

TEST_F(Export, SaysWhatAnEngineDoesNotGet) {
  for (const std::string target : {"godot", "unity", "unreal"}) {
    EXPECT_THAT(exportTo("deep", target, folder() / ("deep_" + target)).error,
                HasSubstr("albedo: rounded from 16 bits to 8"));
    EXPECT_EQ(exportTo("face", target, folder() / ("face_" + target + "_again")).error, "");
  }
  EXPECT_EQ(exportTo("deep", "gltf", folder() / "deep_gltf").error, "") << "a package is copied as it is";
}

TEST_F(Export, BlocksStayWhereATargetTakesThem) {
  const auto exported = [&](const std::string& package, const std::string& target) {
    const fs::path out = folder() / (package + "_to_" + target);
    const test::CommandResult result = exportTo(package, target, out);
    EXPECT_EQ(result.exit_code, 0) << target << ": " << result.error;
    return std::pair(out, result.error);
  };
  for (const std::string target : {"gltf", "three"}) {
    const auto& [out, notes] = exported("astc", target);
    EXPECT_EQ(contentsOf(out / "package/albedo/difference_0.ktx2"),
              contentsOf(folder() / "astc/albedo/difference_0.ktx2"));
    const nlohmann::json scene = nlohmann::json::parse(contentsOf(out / "scene.gltf"));
    EXPECT_EQ(scene["images"][0]["uri"], "textures/albedo_neutral.png") << "glTF knows no blocks";
    EXPECT_EQ(image::readImage(out / "textures/albedo_neutral.png").shape.width, 80);
    EXPECT_EQ(notes, "");
  }
  // Unity: of ASTC the square blocks, of BC whole ones.
  const auto& [unity, none] = exported("bc7", "unity");
  EXPECT_EQ(contentsOf(unity / "textures/albedo_neutral.fzktx2"), contentsOf(folder() / "bc7/albedo/neutral.ktx2"));
  EXPECT_FALSE(fs::exists(unity / "textures/albedo_neutral.png"));
  EXPECT_EQ(none, "");
  const auto& [mixed, said] = exported("astc", "unity");
  EXPECT_TRUE(fs::exists(mixed / "textures/albedo_neutral.fzktx2"));
  EXPECT_TRUE(fs::exists(mixed / "textures/albedo_difference_0.png"));
  EXPECT_THAT(said, HasSubstr("albedo: its astc-8x5 blocks are decoded to PNG"));
  EXPECT_THAT(contentsOf(mixed / "FaceZip.hlsl"), HasSubstr("neutral.Sample(state, from_top)"));
  EXPECT_THAT(contentsOf(mixed / "FaceZip.hlsl"), HasSubstr("difference_0.Sample(state, uv)"));
  EXPECT_TRUE(fs::exists(exported("odd", "unity").first / "textures/albedo_neutral.png"));
  // Those that take no blocks get images.
  const fs::path blender = exported("bc7", "blender").first;
  EXPECT_TRUE(fs::exists(blender / "package/albedo/neutral.png"));
  EXPECT_EQ(Package::open(blender / "package").maps()[0].neutral_format, std::nullopt);
  const auto& [unreal, again] = exported("bc7", "unreal");
  const nlohmann::json face = nlohmann::json::parse(contentsOf(unreal / "FaceZip.json"));
  EXPECT_EQ(face["compression"]["albedo_neutral"], "TC_BC7");
  EXPECT_FALSE(face["compression"].contains("weights_0_0"));
  EXPECT_THAT(again, HasSubstr("which Unreal codes again"));
  EXPECT_THAT(exported("astc", "godot").second, HasSubstr("which Godot 3 keeps uncompressed"));
}

TEST_F(Export, MapsMayShareFiles) {
  const fs::path shared = folder() / "shared";
  fs::copy(folder() / "face", shared, fs::copy_options::recursive);
  nlohmann::json document = nlohmann::json::parse(contentsOf(shared / "package.json"));
  document["maps"][1] = document["maps"][0];
  document["maps"][1]["name"] = "detail";
  io::writeTextFile(shared / "package.json", document.dump());
  fs::remove_all(shared / "normal");
  for (const auto& [target, files] : kFiles) {
    const test::CommandResult result = exportTo("shared", target, folder() / ("shared_" + target));
    EXPECT_EQ(result.exit_code, 0) << target << ": " << result.error;
  }
  EXPECT_TRUE(fs::exists(folder() / "shared_gltf/package/albedo/neutral.png"));
  const std::vector<std::string> files = packageFiles(Package::open(shared));
  EXPECT_EQ(std::set<std::string>(files.begin(), files.end()).size(), files.size());
}

TEST_F(Export, BadInputIsRefusedAndLeavesNothing) {
  const fs::path out = folder() / "refused";
  const auto fails = [&](const test::CommandResult& result, int code, const std::string& part) {
    EXPECT_EQ(result.exit_code, code) << result.error;
    EXPECT_THAT(result.error, HasSubstr(part));
    EXPECT_FALSE(fs::exists(out));
  };
  for (const auto& [target, files] : kFiles) {
    fails(exportTo("bare", target, out), cli::kExitInput, "mesh: expected a package with meshes");
    fails(exportTo("nowhere", target, out), cli::kExitInput, "nowhere");
  }
  for (const std::string target : {"godot", "unity", "unreal"}) {
    fails(exportTo("floats", target, out), cli::kExitInput, "maps: expected one of 8 or 16 bits");
  }
  EXPECT_EQ(exportTo("floats", "gltf", folder() / "floats_gltf").exit_code, 0);
  fails(exportTo("face", "maya", out), cli::kExitUsage, "maya");
}

/// Asked to stop as soon as it works.
class CancelledAtOnce : public Progress {
 public:
  void stage(std::string_view, std::size_t) override { cancel(); }
};

TEST_F(Export, CancelledLeavesNothing) {
  const test::TemporaryDirectory out;
  const Package package = Package::open(folder() / "face");
  for (const std::string& target : exportTargets()) {
    CancelledAtOnce progress;
    EXPECT_THROW(exportPackage(package, target, out / "to", progress), Cancelled) << target;
    EXPECT_TRUE(fs::is_empty(out.path())) << target;
  }
  const Package blocks = Package::open(folder() / "bc7");
  for (const std::string& target : exportTargets()) {
    CancelledAtOnce progress;
    EXPECT_THROW(exportPackage(blocks, target, out / "to", progress), Cancelled) << target;
    EXPECT_TRUE(fs::is_empty(out.path())) << target;
  }
  CancelledAtOnce progress;
  EXPECT_THROW(writeViewer(package, out / "to", progress), Cancelled);
  EXPECT_TRUE(fs::is_empty(out.path()));
}

}  // namespace
}  // namespace facezip
