#include "device/device_context.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "test_device.hpp"

namespace facezip {
namespace {

TEST(DeviceContext, BuffersKeepWhatIsUploaded) {
  device::DeviceContext& context = test::testDevice();
  const std::vector<float> values = {1.0f, -2.0f, 0.5f};
  const cl::Buffer buffer = context.upload(values, "values");
  std::vector<float> back(values.size());
  context.read(buffer, back, "values");
  EXPECT_EQ(back, values);
}

TEST(DeviceContext, RefusesAllocationsBeyondTheDevice) {
  device::DeviceContext& context = test::testDevice();
  EXPECT_THROW(context.allocate(context.info().largest_allocation_bytes + 1, CL_MEM_READ_WRITE, "too much"),
               DeviceError);
}

TEST(DeviceContext, UnknownKernelFileIsADeviceError) {
  EXPECT_THROW(test::testDevice().kernel("no_such_file.cl", "x"), DeviceError);
}

TEST(DeviceContext, AFolderOfKernelsThatIsNotThereIsNamed) {
  ::setenv("FACEZIP_KERNEL_DIR", "/no/such/folder", 1);
  EXPECT_THROW(test::testDevice().kernel("weight_map.cl", "weight_map"), InputError);
  ::unsetenv("FACEZIP_KERNEL_DIR");
}

TEST(OpenDevice, UnknownSelectorListsTheDevices) {
  try {
    openDevice("no such device");
    FAIL() << "expected DeviceError";
  } catch (const DeviceError& error) {
    EXPECT_NE(std::string(error.what()).find(test::testDevice().info().name), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace facezip
