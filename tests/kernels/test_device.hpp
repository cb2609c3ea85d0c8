// test_device.hpp - the device that the kernel tests run on, chosen on the command line.
#pragma once

#include "device/device_context.hpp"

namespace facezip::test {

/// The device of --device SELECTOR (default "auto"), opened once for the whole run.
device::DeviceContext& testDevice();

/// True with --small: keep to sizes that a simulator (Oclgrind) finishes in seconds.
bool smallSizesOnly();

}  // namespace facezip::test
