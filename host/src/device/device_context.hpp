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

#include <concepts>
#include <map>
#include <mutex>
#include <ranges>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "device/program_cache.hpp"
#include "facezip/device.hpp"
#include "facezip/progress.hpp"
#include "io/counts.hpp"

namespace facezip::device {

/// Which form of a kernel to run, where one source cannot serve both kinds of device.
enum class KernelVariant { kAuto, kCpu, kGpu };

/// How many work-items run along one to three axes, and how many form a group:
///   WorkItems(tiles, expressions)                   the driver chooses the groups: only where each size runs once
///   WorkItems(tiles, expressions).inGroupsOf(1, 1)
class WorkItems {
 public:
  template <std::integral... Counts>
  requires(sizeof...(Counts) >= 1 && sizeof...(Counts) <= 3) explicit WorkItems(Counts... counts)
      : all_(toSize(counts)...) {}

  template <std::integral... Counts>
  requires(sizeof...(Counts) >= 1 && sizeof...(Counts) <= 3) WorkItems inGroupsOf(Counts... counts)
  const {
    WorkItems items = *this;
    items.group_ = cl::NDRange(toSize(counts)...);
    return items;
  }

  const cl::NDRange& all() const { return all_; }
  const cl::NDRange& group() const { return group_; }

 private:
  cl::NDRange all_;
  cl::NDRange group_ = cl::NullRange;
};

/// What a kernel takes: a number of exactly the type that its parameter has, a struct that says it is laid out as the
/// kernel's (`using KernelStruct = void;`), or a buffer, or what holds one.
template <typename T>
concept KernelArgument = std::same_as<T, cl_int> || std::same_as<T, cl_ulong> || std::same_as<T, cl_float> ||
                         std::same_as<T, cl_float4> || std::same_as<T, cl::Buffer> ||
                         (std::is_trivially_copyable_v<T>&& requires { typename T::KernelStruct; }) ||
                         requires(const T& holder) {
  { holder.buffer() } -> std::same_as<const cl::Buffer&>;
};

/// Values that lie one behind the other and can be copied as bytes.
template <typename R>
concept Values = std::ranges::contiguous_range<R> && std::ranges::sized_range<R> &&
    std::is_trivially_copyable_v<std::ranges::range_value_t<R>>;

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

  /// Largest work-group along an axis of `count` work-items: as many as divide them, at most 256 and what the device
  /// and `kernel` allow. PoCL compiles a kernel anew for every size of its groups, and where it may choose, it chooses
  /// by all axes: so this takes the one axis that a program fixes.
  std::size_t groupOf(const cl::Kernel& kernel, std::size_t count) const;

  /// Allocates; `what` names the buffer in the DeviceError that is thrown when `bytes` exceeds the device's largest
  /// allocation or the allocation fails. A size of 0 gives a buffer of one byte, since OpenCL has no empty ones.
  cl::Buffer allocate(std::size_t bytes, cl_mem_flags flags, std::string_view what) const;

  /// Allocates and fills.
  template <Values R>
  cl::Buffer upload(const R& values, std::string_view what) const {
    const std::span data(values);
    cl::Buffer buffer = allocate(data.size_bytes(), CL_MEM_READ_ONLY, what);
    write(buffer, data, what);
    return buffer;
  }

  /// Blocking copies between host memory and a buffer, `offset_bytes` into it.
  template <Values R>
  void write(const cl::Buffer& buffer, const R& values, std::string_view what, std::size_t offset_bytes = 0) const {
    const std::span data(values);
    writeBytes(buffer, std::as_bytes(data), what, offset_bytes);
  }
  template <Values R>
  void read(const cl::Buffer& buffer, R&& values, std::string_view what, std::size_t offset_bytes = 0) const {
    const std::span data(values);
    readBytes(buffer, std::as_writable_bytes(data), what, offset_bytes);
  }
  /// The first `count` values of a buffer.
  template <typename T>
  std::vector<T> download(const cl::Buffer& buffer, std::size_t count, std::string_view what) const {
    std::vector<T> values(count);
    read(buffer, values, what);
    return values;
  }

  /// Enqueues `kernel` on queue() with all of its arguments, in their order. Returns the event, for timing.
  /// Throws DeviceError, also where the kernel has more arguments or of other sizes.
  template <KernelArgument... Arguments>
  cl::Event launch(cl::Kernel kernel, const WorkItems& items, const Arguments&... arguments) const {
    cl_uint index = 0;
    (setArgument(kernel, index++, arguments), ...);
    return enqueue(kernel, items, index);
  }
  void finish() const;

 private:
  cl::Program buildProgram(std::string_view file_name, const std::string& options);
  void writeBytes(const cl::Buffer& buffer, std::span<const std::byte> data, std::string_view what,
                  std::size_t offset_bytes) const;
  void readBytes(const cl::Buffer& buffer, std::span<std::byte> data, std::string_view what,
                 std::size_t offset_bytes) const;

  template <typename T>
  void setArgument(cl::Kernel& kernel, cl_uint index, const T& argument) const {
    if constexpr (requires { argument.buffer(); }) {
      setArgument(kernel, index, argument.buffer());
    } else {
      try {
        kernel.setArg(index, argument);
      } catch (const cl::Error& error) {
        throwBadArgument(error, kernel, index);
      }
    }
  }
  [[noreturn]] void throwBadArgument(const cl::Error& error, const cl::Kernel& kernel, cl_uint index) const;
  cl::Event enqueue(const cl::Kernel& kernel, const WorkItems& items, cl_uint argument_count) const;

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

}  // namespace facezip::device
