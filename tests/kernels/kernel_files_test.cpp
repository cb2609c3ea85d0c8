// Kernel files as they lie in the tree: what an editor or another compiler sees of them.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "device/kernel_sources.hpp"
#include "test_device.hpp"

namespace facezip {
namespace {
namespace fs = std::filesystem;

std::vector<fs::path> kernelFiles() {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(FACEZIP_KERNEL_FILES)) {
    if (entry.path().extension() == ".cl") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

class KernelFile : public testing::TestWithParam<fs::path> {};

TEST_P(KernelFile, CompilesAloneWithTheDefaultsOfItsDefines) {
  const device::DeviceContext& context = test::testDevice();
  if (context.info().platform != "Portable Computing Language") GTEST_SKIP() << "one compiler is enough";
  std::ifstream file(GetParam());
  const std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  cl::Program program(context.context(), text);
  try {
    program.build({context.device()}, "-cl-std=CL1.2 -Werror -I " FACEZIP_KERNEL_FILES);
  } catch (const cl::BuildError& error) {
    for (const auto& [device, log] : error.getBuildLog()) ADD_FAILURE() << log;
    return;
  }
  EXPECT_NO_THROW(cl::Kernel(program, GetParam().stem().c_str())) << "no kernel of the file's name";
}

TEST_P(KernelFile, IsPartOfTheBuildWithWhatItIncludes) {
  const std::string source = device::kernelSource(GetParam().filename().string());
  EXPECT_NE(source.find(" " + GetParam().stem().string() + "("), std::string::npos);
  EXPECT_EQ(source.find("\n#include \""), std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(Tree, KernelFile, testing::ValuesIn(kernelFiles()),
                         [](const auto& file) { return file.param.stem().string(); });

}  // namespace
}  // namespace facezip
