#include <fmt/format.h>

#include "commands.hpp"
#include "facezip/device.hpp"
#include "terminal.hpp"

namespace facezip::cli {
namespace {

const char* typeName(DeviceInfo::Type type) {
  return type == DeviceInfo::Type::kCpu ? "CPU" : type == DeviceInfo::Type::kGpu ? "GPU" : "other";
}

void printDevices() {
  const std::vector<DeviceInfo> devices = listDevices();
  if (devices.empty()) {
    throw DeviceError("listing OpenCL devices", 0,
                      "there are none; install the vendor's driver or PoCL (Debian: pocl-opencl-icd)");
  }
  constexpr double kGiB = 1024.0 * 1024.0 * 1024.0;
  for (const DeviceInfo& info : devices) {
    say("{}  {} ({}), {}\n", info.selector, info.name, typeName(info.type), info.platform);
    say("     {} compute units, {:.1f} GiB memory, {:.1f} GiB in one buffer, {}, driver {}\n", info.compute_units,
        static_cast<double>(info.global_memory_bytes) / kGiB, static_cast<double>(info.largest_allocation_bytes) / kGiB,
        info.version, info.driver);
  }
}

}  // namespace

void addDevicesCommand(CLI::App& app, const CommonOptions&) {
  CLI::App* command = app.add_subcommand("devices", "Lists the OpenCL devices and the selectors that --device takes");
  command->callback(printDevices);
}

}  // namespace facezip::cli
