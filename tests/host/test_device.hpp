// test_device.hpp - the device that host tests run on, opened once for the whole run.
#pragma once

#include "facezip/device.hpp"

namespace facezip::test {

inline const Device& testDevice() {
  // Never destroyed: the drivers' own libraries may be gone when static objects are.
  static const Device* device = new Device(openDevice());
  return *device;
}

}  // namespace facezip::test
