// device_context.hpp - the OpenCL objects behind facezip::Device, and the few helpers every step of the method uses.
#pragma once

// Debian's CL/opencl.hpp does not compile with a minimum of 120 and a target of 200 or more: 110 is the safe minimum.
#define CL_HPP_ENABLE_EXCEPTIONS
#define CL_HPP_MINIMUM_OPENCL_VERSION 110
#define CL_HPP_TARGET_OPENCL_VERSION 120
#define CL_TARGET_OPENCL_VERSION 120
#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wignored-attributes"
#pragma GCC diagnostic ignored "-Wold-style-cast"
#pragma GCC diagnostic ignored "-Wpedantic"
#pragma GCC diagnostic ignored "-Wshadow"
#endif
#include <CL/opencl.hpp>
#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

#include <map>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "device/program_cache.hpp"
#include "facezip/device.hpp"
#include "facezip/progress.hpp"

namespace facezip::device {

/// Which form of a kernel to run, where one source cannot serve both kinds of device.
enum class KernelVariant { kAuto, kCpu, kGpu };

class DeviceContext {
 public:
  /// progress  told when kernels are compiled; may be null, else it outlives the context
  explicit DeviceContext(cl::Device device, DeviceInfo info, Progress* progress = nullptr,
                         ProgramCache cache = ProgramCache::ofUser());

  const DeviceInfo& info() const { return info_; }
  const cl::Context& context() const { return context_; }
  const cl::Device& device() const { return device_; }
  /// In-order queue with profiling; a step that overlaps work makes its own.
  const cl::CommandQueue& queue() const { return queue_; }

  /// Returns kernel `name` of kernels/cl/`file_name`, built with `defines` ("-D NAME=VALUE ...").
  /// Programs are built once per (file, defines), from the binary of an earlier process where the cache has one that
  /// the driver takes. Throws DeviceError with the build log.
  cl::Kernel kernel(std::string_view file_name, std::string_view name, const std::string& defines = "");

  /// The variant that runs when `variant` is asked for: kAuto goes by the device's type. Mesa's llvmpipe, a CPU, always
  /// gets kGpu: it ends every work-item after 65,535 rounds of its loops, in all and without a word (gallivm's
  /// LP_MAX_TGSI_LOOP_ITERATIONS), where register-blocked work-items need millions, and it compiles their unrolled
  /// vectors for minutes.
  KernelVariant resolve(KernelVariant variant) const;

  /// Whether the kernels of a variant may ask for memory ahead and shuffle 64 bytes at once, beyond OpenCL C: PoCL's
  /// compiler is clang, and its processors gain by both; GPUs have no need.
  bool clangBuiltins(KernelVariant variant) const;

  /// Largest power-of-two work-group size that the device and `kernel` allow, at most `wanted`.
  std::size_t workGroupSize(const cl::Kernel& kernel, std::size_t wanted) const;

  /// Allocates; `what` names the buffer in the DeviceError that is thrown when `bytes` exceeds the device's largest
  /// allocation or the allocation fails. A size of 0 gives a buffer of one byte, since OpenCL has no empty ones.
  cl::Buffer allocate(std::size_t bytes, cl_mem_flags flags, std::string_view what) const;

  /// Allocates and fills. T must be trivially copyable.
  template <typename T>
  cl::Buffer upload(std::span<const T> values, std::string_view what) const {
    cl::Buffer buffer = allocate(values.size_bytes(), CL_MEM_READ_ONLY, what);
    if (!values.empty()) write(buffer, values.data(), values.size_bytes(), what);
    return buffer;
  }
  template <typename T>
  cl::Buffer upload(const std::vector<T>& values, std::string_view what) const {
    return upload(std::span<const T>(values), what);
  }

  /// Blocking copies between host memory and a buffer, `offset_bytes` into it.
  void write(const cl::Buffer& buffer, const void* data, std::size_t bytes, std::string_view what,
             std::size_t offset_bytes = 0) const;
  void read(const cl::Buffer& buffer, void* data, std::size_t bytes, std::string_view what,
            std::size_t offset_bytes = 0) const;

  /// Enqueues `kernel` on queue(). `local` may be cl::NullRange. Returns the event, for timing.
  cl::Event run(const cl::Kernel& kernel, const cl::NDRange& global, const cl::NDRange& local) const;
  void finish() const;

 private:
  cl::Program buildProgram(std::string_view file_name, const std::string& options);

  DeviceInfo info_;
  Progress* progress_;
  ProgramCache cache_;
  cl::Device device_;
  cl::Context context_;
  cl::CommandQueue queue_;
  std::mutex programs_mutex_;
  std::map<std::string, cl::Program> programs_;
};

/// Converts a failed OpenCL call into the DeviceError that facezip throws; `step` says what was being done.
DeviceError toDeviceError(const cl::Error& error, std::string_view step, const DeviceInfo& info);

/// Smallest multiple of `step` that is not below `value`.
constexpr std::size_t roundUp(std::size_t value, std::size_t step) { return (value + step - 1) / step * step; }

}  // namespace facezip::device
