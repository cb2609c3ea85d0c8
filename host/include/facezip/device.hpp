// device.hpp - the OpenCL device that facezip computes on.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "facezip/error.hpp"

namespace facezip {

class Progress;
namespace device {
class DeviceContext;
}

/// What `facezip devices` prints of one OpenCL device.
struct DeviceInfo {
  std::string selector;  ///< "PLATFORM:DEVICE", both counted from 0 in the ICD loader's order; openDevice() takes it
  std::string platform;  ///< for example "Portable Computing Language"
  std::string name;
  std::string vendor;
  std::string driver;   ///< driver version
  std::string version;  ///< OpenCL version string of the device
  enum class Type { kCpu, kGpu, kOther } type = Type::kOther;
  unsigned compute_units = 0;
  std::uint64_t global_memory_bytes = 0;
  std::uint64_t largest_allocation_bytes = 0;
  std::uint64_t local_memory_bytes = 0;
  std::size_t largest_work_group = 0;
};

/// An OpenCL call failed, or no device answers to a selector.
class DeviceError : public Error {
 public:
  /// call      what failed: a step and an OpenCL function
  /// code      OpenCL error code; 0 when none applies
  /// detail    device name, build log, cure
  DeviceError(const std::string& call, int code, const std::string& detail);
  int code() const noexcept { return code_; }

 private:
  int code_;
};

/// Lists every device of every OpenCL platform; empty when there is none.
std::vector<DeviceInfo> listDevices();

/// A device made ready for use: its context, its queue and the kernels built so far. Cheap to copy; copies share.
class Device {
 public:
  explicit Device(std::shared_ptr<device::DeviceContext> context) : context_(std::move(context)) {}
  const DeviceInfo& info() const;

  /// The OpenCL side, for facezip's own sources.
  device::DeviceContext& context() const { return *context_; }

 private:
  std::shared_ptr<device::DeviceContext> context_;
};

/// Opens the device that `selector` names:
///   "auto"          the first GPU, else the first CPU, else the first device (also what "" means)
///   "gpu", "cpu"    the first device of that type
///   "pocl"          the first device of the platform "Portable Computing Language"
///   "P:D", "P"      device D (default 0) of platform P, as `facezip devices` counts them
///   other text      the first device whose name or platform contains it, upper and lower case alike
/// Throws DeviceError that lists what there is, or says how to install a driver when there is nothing.
/// progress  told when kernels are compiled, which takes seconds the first time: binaries are kept in
/// FACEZIP_CACHE_DIR,
///           else in the user's cache folder. May be null; else it outlives every copy of the device
Device openDevice(std::string_view selector = "auto", Progress* progress = nullptr);

}  // namespace facezip
