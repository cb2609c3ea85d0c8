#include "facezip/device.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <optional>
#include <utility>

#include "device/device_context.hpp"
#include "device/pocl_cache.hpp"
#include "facezip/printable.hpp"

namespace facezip {
namespace {

struct FoundDevice {
  DeviceInfo info;
  cl::Device device;
};

DeviceInfo describe(const cl::Platform& platform, const cl::Device& device, std::size_t platform_index,
                    std::size_t device_index) {
  DeviceInfo info;
  info.selector = fmt::format("{}:{}", platform_index, device_index);
  info.platform = platform.getInfo<CL_PLATFORM_NAME>();
  info.name = device.getInfo<CL_DEVICE_NAME>();
  info.vendor = device.getInfo<CL_DEVICE_VENDOR>();
  info.driver = device.getInfo<CL_DRIVER_VERSION>();
  info.version = device.getInfo<CL_DEVICE_VERSION>();
  const cl_device_type type = device.getInfo<CL_DEVICE_TYPE>();
  // A simulator may claim every type; what it runs on decides, so CPU is asked first.
  info.type = (type & CL_DEVICE_TYPE_CPU) != 0   ? DeviceInfo::Type::kCpu
              : (type & CL_DEVICE_TYPE_GPU) != 0 ? DeviceInfo::Type::kGpu
                                                 : DeviceInfo::Type::kOther;
  info.compute_units = device.getInfo<CL_DEVICE_MAX_COMPUTE_UNITS>();
  info.global_memory_bytes = device.getInfo<CL_DEVICE_GLOBAL_MEM_SIZE>();
  info.largest_allocation_bytes = device.getInfo<CL_DEVICE_MAX_MEM_ALLOC_SIZE>();
  info.local_memory_bytes = device.getInfo<CL_DEVICE_LOCAL_MEM_SIZE>();
  info.largest_work_group = device.getInfo<CL_DEVICE_MAX_WORK_GROUP_SIZE>();
  return info;
}

std::vector<FoundDevice> findDevices() {
  device::givePoclAPlace();
  std::vector<cl::Platform> platforms;
  try {
    cl::Platform::get(&platforms);
  } catch (const cl::Error&) {
    return {};  // the loader reports "no platform" as an error
  }
  std::vector<FoundDevice> found;
  for (std::size_t p = 0; p < platforms.size(); ++p) {
    std::vector<cl::Device> devices;
    try {
      platforms[p].getDevices(CL_DEVICE_TYPE_ALL, &devices);
    } catch (const cl::Error&) {
      continue;  // a platform without devices is not an error for the others
    }
    for (std::size_t d = 0; d < devices.size(); ++d) {
      found.push_back({describe(platforms[p], devices[d], p, d), devices[d]});
    }
  }
  return found;
}

constexpr const char* kPocl = "Portable Computing Language";

/// Why there is no device where there could be one, a sentence; else empty.
std::string reasonForNone() {
  std::vector<cl::Platform> platforms;
  try {
    cl::Platform::get(&platforms);
  } catch (const cl::Error&) {
    return "";
  }
  const bool pocl = std::any_of(platforms.begin(), platforms.end(), [](const cl::Platform& platform) {
    return platform.getInfo<CL_PLATFORM_NAME>() == kPocl;
  });
  return pocl ? device::poclCacheFault() : "";
}

std::string lowerCase(std::string_view text) {
  std::string lower(text);
  std::transform(lower.begin(), lower.end(), lower.begin(), [](unsigned char c) { return std::tolower(c); });
  return lower;
}

bool matches(const DeviceInfo& info, const std::string& selector) {
  const bool index = selector.find_first_not_of("0123456789:") == std::string::npos;
  if (index) return info.selector == (selector.find(':') == std::string::npos ? selector + ":0" : selector);
  if (selector == "gpu") return info.type == DeviceInfo::Type::kGpu;
  if (selector == "cpu") return info.type == DeviceInfo::Type::kCpu;
  // Everybody calls it PoCL; the platform does not.
  if (selector == "pocl") return info.platform == kPocl;
  return lowerCase(info.name).find(selector) != std::string::npos ||
         lowerCase(info.platform).find(selector) != std::string::npos;
}

std::optional<FoundDevice> choose(const std::vector<FoundDevice>& found, const std::string& selector) {
  const auto first = [&found](const std::string& wanted) -> std::optional<FoundDevice> {
    const auto it =
        std::find_if(found.begin(), found.end(), [&](const FoundDevice& f) { return matches(f.info, wanted); });
    if (it == found.end()) return std::nullopt;
    return *it;
  };
  if (selector != "auto" && !selector.empty()) return first(selector);
  if (auto gpu = first("gpu")) return gpu;
  if (auto cpu = first("cpu")) return cpu;
  if (found.empty()) return std::nullopt;
  return found.front();
}

}  // namespace

DeviceError::DeviceError(const std::string& call, int code, const std::string& detail)
    : Error(code == 0 ? fmt::format("{}: {}", call, detail)
                      : fmt::format("{}: OpenCL error {}: {}", call, code, detail)),
      code_(code) {}

std::vector<DeviceInfo> listDevices() {
  std::vector<DeviceInfo> infos;
  for (const FoundDevice& found : findDevices()) infos.push_back(found.info);
  if (!infos.empty()) return infos;
  if (const std::string fault = reasonForNone(); !fault.empty()) {
    throw DeviceError("listing OpenCL devices", 0, fault);
  }
  return infos;
}

const DeviceInfo& Device::info() const { return context_->info(); }

Device openDevice(std::string_view selector, Progress* progress) {
  const std::vector<FoundDevice> found = findDevices();
  if (found.empty()) {
    const std::string fault = reasonForNone();
    throw DeviceError("opening an OpenCL device", 0,
                      !fault.empty() ? fault
                                     : "no OpenCL device found; install the vendor's driver or PoCL (Debian: "
                                       "pocl-opencl-icd), then see `facezip devices`");
  }
  std::optional<FoundDevice> chosen = choose(found, lowerCase(selector));
  if (!chosen) {
    std::string available;
    for (const FoundDevice& f : found)
      available += fmt::format("\n  {}  {} ({})", f.info.selector, f.info.name, f.info.platform);
    throw DeviceError(fmt::format("--device {}", printable(selector)), 0,
                      fmt::format("no such device; there are:{}", available));
  }
  return Device(std::make_shared<device::DeviceContext>(std::move(chosen->device), std::move(chosen->info), progress));
}

}  // namespace facezip
