// guarded_buffer.hpp - an output buffer whose last bytes must not be touched.
#pragma once

#include <cstddef>
#include <stdexcept>
#include <vector>

#include "device/device_context.hpp"

namespace facezip::test {

/// A buffer of `bytes` with a guard behind it. Everything starts as 0xA5, so that an output that was never written
/// shows.
class GuardedBuffer {
 public:
  GuardedBuffer(const device::DeviceContext& context, std::size_t bytes)
      : context_(context),
        bytes_(bytes),
        buffer_(context.allocate(bytes + kGuard, CL_MEM_READ_WRITE, "output and guard")) {
    context.write(buffer_, fill(bytes + kGuard), "output and guard");
  }

  const cl::Buffer& buffer() const { return buffer_; }

  /// The contents. Throws where the guard has changed: a kernel wrote past its output.
  template <typename T>
  std::vector<T> read() const {
    std::vector<unsigned char> guard(kGuard);
    context_.read(buffer_, guard, "guard", bytes_);
    if (guard != fill(kGuard)) throw std::logic_error("a kernel wrote past the end of its output");
    return context_.download<T>(buffer_, bytes_ / sizeof(T), "output");
  }

 private:
  static constexpr std::size_t kGuard = 4096;
  static std::vector<unsigned char> fill(std::size_t bytes) { return std::vector<unsigned char>(bytes, 0xA5); }

  const device::DeviceContext& context_;
  std::size_t bytes_;
  cl::Buffer buffer_;
};

}  // namespace facezip::test
