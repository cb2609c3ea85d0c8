// Runs the kernel tests on the device that is named: facezip_kernel_tests [--device SELECTOR] [--small] [gtest options]
#include <gtest/gtest.h>

#include <cstdio>
#include <optional>
#include <string>
#include <string_view>

#include "test_device.hpp"

namespace facezip::test {
namespace {

std::string g_selector = "auto";
bool g_small = false;

}  // namespace

device::DeviceContext& testDevice() {
  // Never destroyed: drivers tear themselves down at exit, some before our statics (Oclgrind aborts).
  static Device& device = *new Device(openDevice(g_selector));
  return device.context();
}

bool smallSizesOnly() { return g_small; }

}  // namespace facezip::test

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  for (int i = 1; i < argc; ++i) {
    const std::string_view argument = argv[i];
    if (argument == "--device" && i + 1 < argc) {
      facezip::test::g_selector = argv[++i];
    } else if (argument == "--small") {
      facezip::test::g_small = true;
    } else {
      std::fprintf(stderr, "unknown option %s; use [--device SELECTOR] [--small]\n", argv[i]);
      return 2;
    }
  }
  return RUN_ALL_TESTS();
}
