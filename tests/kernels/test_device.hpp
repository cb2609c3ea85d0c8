// test_device.hpp - the device that the kernel tests run on, chosen on the command line.
#pragma once

#include <vector>

#include "device/device_context.hpp"

namespace facezip::test {

/// The device of --device SELECTOR (default "auto"), opened once for the whole run.
device::DeviceContext& testDevice();

/// True with --small: keep to sizes that a simulator (Oclgrind) finishes in seconds.
bool smallSizesOnly();

/// The forms of a kernel that the device has: llvmpipe has one, and running it twice would only look like a test.
inline std::vector<device::KernelVariant> variants() {
  std::vector<device::KernelVariant> has;
  for (const device::KernelVariant variant : {device::KernelVariant::kCpu, device::KernelVariant::kGpu}) {
    if (testDevice().resolve(variant) == variant) has.push_back(variant);
  }
  return has;
}

}  // namespace facezip::test
