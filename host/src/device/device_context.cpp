#include "device/device_context.hpp"

#include <fmt/format.h>

#include <bit>
#include <cassert>
#include <optional>

#include "device/kernel_sources.hpp"

namespace facezip::device {

namespace {

/// Everything that decides what a binary is.
std::string cacheKey(const cl::Device& device, const DeviceInfo& info, const std::string& options,
                     const std::string& source) {
  const cl::Platform platform(device.getInfo<CL_DEVICE_PLATFORM>());
  return fmt::format("{}\n{}\n{}\n{}\n{}\n{}\n{}\n{}", platform.getInfo<CL_PLATFORM_NAME>(),
                     platform.getInfo<CL_PLATFORM_VERSION>(), info.vendor, info.name, info.version, info.driver,
                     options, source);
}

/// What every program is built with. clang describes the restrict of inlined functions by an intrinsic that Oclgrind
/// does not know, and then refuses the kernel.
std::string commonOptions(const DeviceInfo& info) {
  return info.platform == "Oclgrind" ? "-cl-std=CL1.2 -D restrict=" : "-cl-std=CL1.2";
}

/// The program of a kept binary; none when the driver refuses it.
std::optional<cl::Program> fromBinary(const cl::Context& context, const cl::Device& device,
                                      const std::vector<unsigned char>& binary, const std::string& options) {
  try {
    cl::Program program(context, {device}, {binary});
    program.build({device}, options.c_str());
    // Some drivers take any bytes and find out when kernels are asked for.
    if (program.getInfo<CL_PROGRAM_NUM_KERNELS>() == 0) return std::nullopt;
    return program;
  } catch (const cl::Error&) {
    return std::nullopt;
  }
}

std::vector<unsigned char> binaryOf(const cl::Program& program) {
  try {
    const std::vector<std::vector<unsigned char>> binaries = program.getInfo<CL_PROGRAM_BINARIES>();
    return binaries.empty() ? std::vector<unsigned char>() : binaries.front();
  } catch (const cl::Error&) {
    return {};  // a driver that gives none: compiled in every process
  }
}

}  // namespace

DeviceContext::DeviceContext(cl::Device device, DeviceInfo info, Progress* progress, ProgramCache cache)
    : info_(std::move(info)), progress_(progress), cache_(std::move(cache)), device_(std::move(device)) {
  try {
    context_ = cl::Context(device_);
    queue_ = cl::CommandQueue(context_, device_, CL_QUEUE_PROFILING_ENABLE);
  } catch (const cl::Error& error) {
    throw toDeviceError(error, "opening the device", info_);
  }
}

cl::Program DeviceContext::buildProgram(std::string_view file_name, const std::string& options) {
  const std::string source = kernelSource(file_name);
  const std::string key = cacheKey(device_, info_, options, source);
  if (const auto binary = cache_.find(key)) {
    if (auto program = fromBinary(context_, device_, *binary, options)) return *program;
  }
  if (progress_ != nullptr) progress_->busy(fmt::format("compiling kernels ({})", file_name));
  cl::Program program(context_, source);
  program.build({device_}, options.c_str());
  // Asked for alone where it is kept: for its binary PoCL compiles every kernel once more, for groups of any size.
  if (cache_.keeps()) cache_.store(key, binaryOf(program));
  return program;
}

cl::Kernel DeviceContext::kernel(std::string_view file_name, std::string_view name, const std::string& defines) {
  const std::scoped_lock lock(programs_mutex_);
  const std::string key = fmt::format("{} {}", file_name, defines);
  auto found = programs_.find(key);
  try {
    if (found == programs_.end()) {
      found =
          programs_.emplace(key, buildProgram(file_name, fmt::format("{} {}", commonOptions(info_), defines))).first;
    }
    return cl::Kernel(found->second, std::string(name).c_str());
  } catch (const cl::BuildError& error) {
    std::string log;
    for (const auto& [failed, text] : error.getBuildLog()) log += text;
    throw DeviceError(fmt::format("building {} ({})", file_name, defines), error.err(),
                      fmt::format("on {}:\n{}", info_.name, log));
  } catch (const cl::Error& error) {
    throw toDeviceError(error, fmt::format("kernel {} of {}", name, file_name), info_);
  }
}

KernelVariant DeviceContext::resolve(KernelVariant variant) const {
  if (info_.name.find("llvmpipe") != std::string::npos) return KernelVariant::kGpu;
  if (variant != KernelVariant::kAuto) return variant;
  return info_.type == DeviceInfo::Type::kGpu ? KernelVariant::kGpu : KernelVariant::kCpu;
}

bool DeviceContext::clangBuiltins(KernelVariant variant) const {
  return resolve(variant) == KernelVariant::kCpu && info_.platform == "Portable Computing Language";
}

std::size_t DeviceContext::workGroupSize(const cl::Kernel& kernel, std::size_t wanted) const {
  const std::size_t allowed =
      std::min(info_.largest_work_group, kernel.getWorkGroupInfo<CL_KERNEL_WORK_GROUP_SIZE>(device_));
  return std::bit_floor(std::max<std::size_t>(1, std::min(wanted, allowed)));
}

std::size_t DeviceContext::groupOf(const cl::Kernel& kernel, std::size_t count) const {
  std::size_t group = std::min(count, workGroupSize(kernel, 256));
  while (count % group != 0) --group;
  return group;
}

cl::Buffer DeviceContext::allocate(std::size_t bytes, cl_mem_flags flags, std::string_view what) const {
  if (bytes > info_.largest_allocation_bytes) {
    throw DeviceError(fmt::format("allocating {} bytes for {}", bytes, what), CL_INVALID_BUFFER_SIZE,
                      fmt::format("{} allows {} bytes in one buffer; lower --memory or choose another --device",
                                  info_.name, info_.largest_allocation_bytes));
  }
  try {
    return cl::Buffer(context_, flags, std::max<std::size_t>(bytes, 1));
  } catch (const cl::Error& error) {
    throw toDeviceError(error, fmt::format("allocating {} bytes for {}", bytes, what), info_);
  }
}

void DeviceContext::writeBytes(const cl::Buffer& buffer, std::span<const std::byte> data, std::string_view what,
                               std::size_t offset_bytes) const {
  if (data.empty()) return;
  try {
    queue_.enqueueWriteBuffer(buffer, CL_TRUE, offset_bytes, data.size(), data.data());
  } catch (const cl::Error& error) {
    throw toDeviceError(error, fmt::format("writing {}", what), info_);
  }
}

void DeviceContext::readBytes(const cl::Buffer& buffer, std::span<std::byte> data, std::string_view what,
                              std::size_t offset_bytes) const {
  if (data.empty()) return;
  try {
    queue_.enqueueReadBuffer(buffer, CL_TRUE, offset_bytes, data.size(), data.data());
  } catch (const cl::Error& error) {
    throw toDeviceError(error, fmt::format("reading {}", what), info_);
  }
}

void DeviceContext::throwBadArgument(const cl::Error& error, const cl::Kernel& kernel, cl_uint index) const {
  throw toDeviceError(error, fmt::format("argument {} of {}", index, kernel.getInfo<CL_KERNEL_FUNCTION_NAME>()), info_);
}

cl::Event DeviceContext::enqueue(const cl::Kernel& kernel, const WorkItems& items,
                                 [[maybe_unused]] cl_uint argument_count) const {
  // A kernel keeps what an earlier launch set: one argument too few would go unseen where it is launched twice.
  assert(kernel.getInfo<CL_KERNEL_NUM_ARGS>() == argument_count);
  cl::Event event;
  try {
    queue_.enqueueNDRangeKernel(kernel, cl::NullRange, items.all(), items.group(), nullptr, &event);
  } catch (const cl::Error& error) {
    throw toDeviceError(error, fmt::format("running {}", kernel.getInfo<CL_KERNEL_FUNCTION_NAME>()), info_);
  }
  return event;
}

void DeviceContext::finish() const {
  try {
    queue_.finish();
  } catch (const cl::Error& error) {
    throw toDeviceError(error, "waiting for the device", info_);
  }
}

DeviceError toDeviceError(const cl::Error& error, std::string_view step, const DeviceInfo& info) {
  return DeviceError(fmt::format("{} ({})", step, error.what()), error.err(), fmt::format("on {}", info.name));
}

}  // namespace facezip::device
