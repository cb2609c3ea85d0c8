// Eyes and teeth behind a template's skin: on the subject, in the package, in glTF, in models.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "facezip/check.hpp"
#include "facezip/export.hpp"
#include "facezip/geometry/obj_io.hpp"
#include "facezip/learn.hpp"
#include "facezip/package.hpp"
#include "facezip/rig.hpp"
#include "file_contents.hpp"
#include "image/image_file.hpp"
#include "io/write_file.hpp"
#include "learn/face_model.hpp"
#include "learn_library.hpp"
#include "mesh/package_mesh.hpp"
#include "package/package_json.hpp"
#include "rig/iris.hpp"
#include "rig/part_looks.hpp"
#include "rig_capture.hpp"
#include "template_parts.hpp"
#include "temporary_directory.hpp"
#include "test_device.hpp"

namespace facezip {
namespace {
namespace fs = std::filesystem;
using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;

RigOptions quickOptions() {
  RigOptions options;
  options.compress.unit = "m";
  options.compress.mask_radius = geometry::parseLength("5cm");
  options.compress.restarts = 2;
  options.compress.cluster_restarts = 2;
  options.fit.iterations = 2;
  return options;
}

template <typename Work>
std::string refusalOf(const Work& work) {
  try {
    work();
  } catch (const InputError& error) {
    return error.what();
  }
  return "not refused";
}

/// A rig with parts, made once.
class RigParts : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new test::TemporaryDirectory;
    test::writeRigCapture(folder());
    test::appendParts(folder() / "template");
    rig("face", quickOptions());
  }
  static void TearDownTestSuite() { delete folder_; }
  static fs::path folder() { return folder_->path(); }
  static fs::path face() { return folder() / "face"; }
  static RigReport rig(const std::string& package, const RigOptions& options) {
    Progress progress;
    return rigCapture(openCapture(folder() / "capture"), folder() / "template", folder() / package, options,
                      test::testDevice(), progress);
  }
  /// The rig with another package.json.
  static fs::path changed(const std::string& name, const std::function<void(json&)>& change) {
    fs::copy(face(), folder() / name, fs::copy_options::recursive);
    json document = json::parse(test::contentsOf(face() / "package.json"));
    change(document);
    io::writeTextFile(folder() / name / "package.json", document.dump());
    return folder() / name;
  }
  static std::string checkOf(const fs::path& package) {
    Progress progress;
    return refusalOf([&] { checkTexels(Package::open(package), progress); });
  }

  static test::TemporaryDirectory* folder_;
};

test::TemporaryDirectory* RigParts::folder_ = nullptr;

TEST_F(RigParts, ThePackageHasThemWithTheirMaterials) {
  const Package package = Package::open(face());
  ASSERT_TRUE(package.description().parts.has_value());
  const std::vector<PackageMaterial>& materials = package.description().parts->materials;
  ASSERT_EQ(materials.size(), 2u);
  EXPECT_EQ(materials[0].name, "eyes");
  EXPECT_EQ(materials[1].name, "teeth");
  EXPECT_EQ(checkOf(face()), "not refused");
  // The template's own texture, texel by texel; irises are painted.
  EXPECT_EQ(image::readImage(face() / materials[1].texture).samples,
            image::readImage(folder() / "template/teeth.png").samples);
  const image::Image eyes = image::readImage(face() / materials[0].texture);
  EXPECT_EQ(eyes.shape.width, materials[0].width);
  const auto at = [&](int x, int y) {
    const auto texel = static_cast<std::size_t>((y * eyes.shape.width + x) * 3);
    return std::to_integer<int>(eyes.samples[texel]) + std::to_integer<int>(eyes.samples[texel + 1]) +
           std::to_integer<int>(eyes.samples[texel + 2]);
  };
  // The front is in the middle of the layout, the back at its edge. Eyes look out of the skin, not quite along z.
  const int middle = eyes.shape.width / 2;
  const double degree = 0.48 * eyes.shape.width / 180.0;  // texels
  int darkest = 765;
  for (int x = -20; x <= 20; ++x) {
    for (int y = -20; y <= 20; ++y) {
      darkest = std::min(darkest, at(middle + static_cast<int>(x * degree), middle + static_cast<int>(y * degree)));
    }
  }
  EXPECT_LT(darkest, 60);  // the pupil
  const int white = static_cast<int>(60.0 * degree);
  EXPECT_GT(at(middle, middle + white), 3 * 100);
  EXPECT_GT(at(middle, middle - white), 3 * 100);
}

TEST_F(RigParts, TheyMoveWithTheShapesAndTheCapturedExpressions) {
  const Package package = Package::open(face());
  const mesh::PackageMesh mesh = mesh::readPackageMesh(package, UINT64_MAX);
  const mesh::PackageMesh parts = mesh::readPackageParts(package, mesh, UINT64_MAX);
  EXPECT_EQ(parts.targets, package.expressions().size());
  EXPECT_EQ(parts.document["meshes"][0]["primitives"].size(), 2u);
  const Eigen::MatrixX3d neutral = geometry::readObj(face() / "shapes/neutral.obj").positions;
  const Eigen::MatrixX3d shape = geometry::readObj(face() / "shapes/bumpA.obj").positions;
  const Eigen::MatrixX3d moved = shape - neutral;
  const int skin = test::kRigSide * test::kRigSide, ball = (test::kBallRings + 1) * test::kBallSegments;
  ASSERT_EQ(neutral.rows(), skin + 2 * ball + 3);
  EXPECT_NEAR(moved(skin + 5, 2), 0.001, 3e-4);
  EXPECT_NEAR(moved.bottomRows(3).norm(), 0.0, 1e-5);
  // Balls stay balls: their points are as far from their middle as those of others.
  const Eigen::MatrixX3d one = neutral.middleRows(skin, ball);
  const Eigen::RowVector3d middle = 0.5 * (one.row(0) + one.row(ball - 1));
  const Eigen::VectorXd radii = (one.rowwise() - middle).rowwise().norm();
  EXPECT_NEAR(radii.minCoeff(), radii.maxCoeff(), 1e-5 * radii.maxCoeff());
}

TEST_F(RigParts, GltfHasAPrimitiveForEach) {
  const auto primitives = [](const fs::path& file) {
    return json::parse(test::contentsOf(file))["meshes"][0]["primitives"];
  };
  const json rigged = json::parse(test::contentsOf(face() / "rig.gltf"));
  EXPECT_EQ(primitives(face() / "rig.gltf").size(), 3u);
  EXPECT_EQ(rigged["images"][1]["uri"], "parts/eyes.png");
  for (const char* target : {"gltf", "godot", "unity"}) {
    Progress progress;
    const fs::path out = folder() / target;
    exportPackage(Package::open(face()), target, out, progress, std::uint64_t{1} << 30);
    EXPECT_EQ(primitives(out / "scene.gltf").size(), 3u);
    for (const json& image : json::parse(test::contentsOf(out / "scene.gltf"))["images"]) {
      EXPECT_TRUE(fs::exists(out / image["uri"].get<std::string>())) << image;
    }
  }
}

TEST_F(RigParts, EyesMayBeChosen) {
  RigOptions options = quickOptions();
  options.eyes = "#5a7ea0";
  rig("blue", options);
  EXPECT_NE(test::contentsOf(folder() / "blue/parts/eyes.png"), test::contentsOf(face() / "parts/eyes.png"));
  options.eyes = "blue";
  rig("blue_too", options);
  EXPECT_EQ(test::contentsOf(folder() / "blue/parts/eyes.png"), test::contentsOf(folder() / "blue_too/parts/eyes.png"));
  options.eyes = "bleu";
  EXPECT_THAT(refusalOf([&] { rig("none", options); }), testing::AllOf(HasSubstr("--eyes"), HasSubstr("light-blue")));
}

TEST_F(RigParts, WithoutAMeshThereAreNone) {
  RigOptions options = quickOptions();
  options.compress.mesh = false;
  rig("bare", options);
  EXPECT_FALSE(Package::open(folder() / "bare").description().parts.has_value());
  EXPECT_FALSE(fs::exists(folder() / "bare/parts.glb"));
}

TEST_F(RigParts, PackagesOfStrangersAreChecked) {
  EXPECT_THAT(checkOf(changed("twice", [](json& d) { d["parts"]["materials"][1]["name"] = "eyes"; })),
              HasSubstr("unique names of materials"));
  EXPECT_THAT(checkOf(changed("few", [](json& d) { d["parts"]["materials"].erase(1); })), HasSubstr("primitives"));
  EXPECT_THAT(checkOf(changed("out", [](json& d) { d["parts"]["file"] = "../parts.glb"; })), HasSubstr("parts.file"));
  EXPECT_THAT(checkOf(changed("size", [](json& d) { d["parts"]["materials"][0]["texture"]["width"] = 7; })),
              HasSubstr("eyes.png"));
  EXPECT_THAT(checkOf(changed("bright", [](json& d) { d["parts"]["materials"][0]["colour"][1] = 2; })),
              HasSubstr("colour[1]"));
  EXPECT_THAT(checkOf(changed("alone", [](json& d) { d.erase("mesh"); })), HasSubstr("parts"));
  // Targets of other names: sliders would not move them.
  const fs::path other = changed("other", [](json& d) { d["parts"]["file"] = "mesh_of_another.glb"; });
  std::string glb = test::contentsOf(face() / "parts.glb");
  glb.replace(glb.find("\"bumpB\""), 7, "\"bumpD\"");
  io::writeTextFile(other / "mesh_of_another.glb", glb);
  EXPECT_THAT(checkOf(other), HasSubstr("targetNames"));
}

TEST_F(RigParts, TexturesThatCannotBeTakenAreNamed) {
  const image::ImageShape shape{4, 4, 3, image::SampleType::kUint16};
  const fs::path texture = folder() / "template/teeth.png";
  const std::string before = test::contentsOf(texture);
  image::writeImage(texture, {shape, std::vector<std::byte>(96)});
  EXPECT_THAT(refusalOf([&] { rig("none", quickOptions()); }),
              testing::AllOf(HasSubstr("teeth.png"), HasSubstr("8 bits")));
  io::writeTextFile(texture, "no image");
  EXPECT_THAT(refusalOf([&] { rig("none", quickOptions()); }), HasSubstr("teeth.png"));
  io::writeTextFile(texture, before);
}

TEST(PartLooks, NamesSayWhatPartsAre) {
  const auto paintOf = [](const std::string& name) { return rig::lookOf(name).paint; };
  const auto placeOf = [](const std::string& name) { return rig::lookOf(name).place; };
  EXPECT_EQ(paintOf("M_Eyeball_L"), rig::PartPaint::kIris);
  EXPECT_EQ(paintOf("EyeOcclusionL"), rig::PartPaint::kShade);
  EXPECT_EQ(paintOf("eyelashes"), rig::PartPaint::kHairs);
  EXPECT_EQ(paintOf("eye_sockets"), rig::PartPaint::kNone);
  EXPECT_EQ(placeOf("TeethUpper"), rig::PartPlace::kMouth);
  EXPECT_EQ(placeOf("gums_and_tongue"), rig::PartPlace::kMouth);
  EXPECT_EQ(placeOf("helmet"), rig::PartPlace::kAlone);
  EXPECT_EQ(rig::knownParts(26719).size(), 12u);
  EXPECT_TRUE(rig::knownParts(26720).empty());
}

TEST(Irises, TheNearestColourIsTaken) {
  EXPECT_EQ(rig::findIris("", "").name, "brown");
  EXPECT_EQ(rig::findIris("#2a1a12", "").name, "dark-brown");
  EXPECT_EQ(rig::findIris("#6f7850", "").name, "green");
  EXPECT_EQ(rig::findIris("#9ab8cc", "").name, "light-blue");
  for (const rig::Iris& iris : rig::irises()) EXPECT_EQ(rig::findIris(iris.name, "").name, iris.name);
}

TEST(LearnedParts, ModelsKeepThemAndGeneratedFacesHaveThem) {
  const test::TemporaryDirectory folder;
  test::writeLearnLibrary(folder.path(), 4);
  test::appendParts(folder / "library/template");
  Progress progress;
  TrainOptions train;
  train.resolution = 64;
  trainModel(folder / "library", folder / "library/template", folder / "library/facs.json", folder / "model", train,
             progress);
  learn::writeModel(folder / "copy", learn::readModel(folder / "model"), progress);
  EXPECT_EQ(test::contentsOf(folder / "model"), test::contentsOf(folder / "copy"));
  GenerateOptions options;
  options.compress = quickOptions().compress;
  options.eyes = "green";
  generateFace(openCapture(folder / "stranger", {}, nullptr, NeutralAlone::kAllowed), folder / "model", folder / "face",
               options, test::testDevice(), progress);
  const Package package = Package::open(folder / "face");
  ASSERT_TRUE(package.description().parts.has_value());
  EXPECT_EQ(package.description().parts->materials.size(), 2u);
  EXPECT_EQ(image::readImage(folder / "face/parts/teeth.png").samples,
            image::readImage(folder / "library/template/teeth.png").samples);
  EXPECT_NO_THROW(checkTexels(package, progress));
}

}  // namespace
}  // namespace facezip
