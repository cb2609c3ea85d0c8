#include "facezip/reconstruct.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "facezip/blend.hpp"
#include "image/image_file.hpp"
#include "io/staged_directory.hpp"
#include "sample_package.hpp"
#include "temporary_directory.hpp"

namespace facezip {
namespace {
namespace fs = std::filesystem;
using test::SamplePackage;

class Reconstruct : public testing::Test {
 protected:
  Reconstruct() {
    sample_ = test::makeSample({{"albedo", 41, 29, 3, SampleType::kUint8, 8},
                                {"normal", 82, 58, 3, SampleType::kUint16, 16},
                                {"height", 41, 29, 1, SampleType::kFloat32, 4, 1, 16}},
                               3);
    test::writeSample(sample_, folder_ / "package");
  }
  /// Never destroyed: the drivers' own libraries may be gone when static objects are.
  static const Device& device() {
    static const Device* device = new Device(openDevice());
    return *device;
  }
  Package open() const { return Package::open(folder_ / "package"); }
  void run(const std::vector<std::string>& expressions = {}) {
    Progress progress;
    reconstruct(open(), folder_ / "out", expressions, device(), progress);
  }
  /// What must be true after a failure: no output, and no staging directory beside it.
  void expectNothingLeft() const {
    EXPECT_EQ(std::distance(fs::directory_iterator(folder_.path()), fs::directory_iterator()), 1);
  }
  test::TemporaryDirectory folder_;
  SamplePackage sample_;
};

TEST_F(Reconstruct, EqualsBlendingTheExpressionAlone) {
  run();
  const Package package = open();
  Blender blender(package, device());
  for (std::size_t n = 0; n < 3; ++n) {
    std::vector<float> beta(3, 0.0f);
    beta[n] = 1.0f;
    blender.setWeights(beta);
    for (std::size_t m = 0; m < 3; ++m) {
      const PackageMap& map = package.maps()[m];
      std::vector<std::byte> frame(map.frameBytes());
      blender.blend(static_cast<int>(m), frame);
      const char* extension = map.sample_type == SampleType::kFloat32 ? ".exr" : ".png";
      EXPECT_EQ(image::readImage(folder_ / "out" / map.name / (package.expressions()[n] + extension)).samples, frame);
      EXPECT_NE(frame, sample_.neutrals[m]);
    }
  }
}

TEST_F(Reconstruct, WritesOnlyWhatIsNamedAndKeepsOtherFiles) {
  fs::create_directories(folder_ / "out/albedo");
  io::writeTextFile(folder_ / "out/albedo/keep.txt", "mine");
  run({"expression_2"});
  EXPECT_TRUE(fs::exists(folder_ / "out/albedo/keep.txt"));
  EXPECT_TRUE(fs::exists(folder_ / "out/albedo/expression_2.png"));
  EXPECT_TRUE(fs::exists(folder_ / "out/height/expression_2.exr"));
  EXPECT_FALSE(fs::exists(folder_ / "out/albedo/expression_0.png"));
}

TEST_F(Reconstruct, RefusesUnknownAndRepeatedNames) {
  EXPECT_THROW(run({"expresion_1"}), InputError);
  EXPECT_THROW(run({"expression_1", "expression_1"}), InputError);
  expectNothingLeft();
}

TEST_F(Reconstruct, DamageHalfWayLeavesNothing) {
  const Package package = open();
  {
    std::fstream file(folder_ / "package/normal/difference_3.png", std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(4000);
    file.write("damaged!", 8);
  }
  Progress progress;
  EXPECT_THROW(reconstruct(package, folder_ / "out", {}, device(), progress), InputError);
  expectNothingLeft();
}

TEST_F(Reconstruct, CancellingLeavesNothing) {
  class CancelsLate : public Progress {
    void advance(std::size_t done) override {
      if (done > 29) cancel();
    }
  } progress;
  EXPECT_THROW(reconstruct(open(), folder_ / "out", {}, device(), progress), Cancelled);
  expectNothingLeft();
}

}  // namespace
}  // namespace facezip
