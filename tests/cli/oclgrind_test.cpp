// A whole compression under Oclgrind, with the build options that users get: the kernel tests there switch the
// optimiser off, and so do not see what it makes of the kernels.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "image/image_file.hpp"
#include "run_command.hpp"
#include "small_capture.hpp"
#include "temporary_directory.hpp"

namespace facezip {
namespace {
namespace fs = std::filesystem;
using test::quoted;
using test::runFacezip;
using testing::HasSubstr;
using testing::Not;

/// What Oclgrind prints of a kernel that it finds wrong, or cannot run.
void expectNoFindings(const test::CommandResult& result) {
  EXPECT_EQ(result.exit_code, 0) << result.error;
  for (const char* finding : {"data race", "Invalid read", "Invalid write", "OCLGRIND FATAL"}) {
    EXPECT_THAT(result.error, Not(HasSubstr(finding)));
  }
}

double meanDifference(const fs::path& a, const fs::path& b) {
  const image::Image first = image::readImage(a), second = image::readImage(b);
  EXPECT_EQ(first.shape, second.shape);
  double sum = 0.0;
  for (std::size_t i = 0; i < first.samples.size(); ++i) {
    sum += std::abs(std::to_integer<int>(first.samples[i]) - std::to_integer<int>(second.samples[i]));
  }
  return sum / static_cast<double>(first.samples.size());
}

class Oclgrind : public testing::TestWithParam<const char*> {};

TEST_P(Oclgrind, CompressesAndBlendsAsPoclDoes) {
  if (FACEZIP_SANITIZED) GTEST_SKIP() << "oclgrind preloads itself, and the sanitizer must come first";
  const std::string simulator = FACEZIP_OCLGRIND;
  if (simulator.find("NOTFOUND") != std::string::npos) GTEST_SKIP() << "oclgrind is not installed";
  const test::TemporaryDirectory folder;
  test::writeSmallCapture(folder / "capture", {.expressions = 6, .width = 48, .height = 48});
  const auto make = [&](const std::string& name, const std::string& device, const std::string& before) {
    const test::CommandResult compressed =
        runFacezip("compress " + quoted(folder / "capture") + " --output " + quoted(folder / name) + " --method " +
                       GetParam() + " --differences 2 --unit m --mask-radius 8cm --restarts 3 --device " + device,
                   before);
    expectNoFindings(compressed);
    expectNoFindings(runFacezip("blend " + quoted(folder / name) + " --weights e00=1,e03=0.5 --output " +
                                    quoted(folder / (name + ".png")) + " --device " + device,
                                before));
  };
  make("pocl", "portable", "");
  make("oclgrind", "oclgrind", "FACEZIP_CACHE_DIR= " + quoted(fs::path(simulator)) + " --data-races --max-errors 100");
  if (HasFailure()) return;
  EXPECT_LT(meanDifference(folder / "pocl.png", folder / "oclgrind.png"), 0.05);
}

INSTANTIATE_TEST_SUITE_P(Methods, Oclgrind, testing::Values("refined", "closed-loop", "paper"), [](const auto& test) {
  std::string name = test.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

}  // namespace
}  // namespace facezip
