// canary_buffer.hpp - an output buffer whose last bytes must not be touched.
#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

#include "device/device_context.hpp"

namespace facezip::test {

/// A buffer of `bytes` with a guard behind it. Everything starts as 0xA5, so that an output that was never written
/// shows.
class CanaryBuffer {
 public:
  CanaryBuffer(const device::DeviceContext& context, std::size_t bytes)
      : context_(context),
        bytes_(bytes),
        buffer_(context.allocate(bytes + kGuard, CL_MEM_READ_WRITE, "output and canary")) {
    const std::vector<unsigned char> fill(bytes + kGuard, kFill);
    context.write(buffer_, fill, "output and canary");
  }

  const cl::Buffer& buffer() const { return buffer_; }

  /// The contents; fails the test if the guard has changed.
  template <typename T>
  std::vector<T> read() const {
    std::vector<unsigned char> guard(kGuard);
    context_.read(buffer_, guard, "canary", bytes_);
    EXPECT_EQ(guard, std::vector<unsigned char>(kGuard, kFill)) << "wrote past the end of the output";
    std::vector<T> values(bytes_ / sizeof(T));
    context_.read(buffer_, values, "output");
    return values;
  }

 private:
  static constexpr std::size_t kGuard = 256;
  static constexpr unsigned char kFill = 0xA5;
  const device::DeviceContext& context_;
  std::size_t bytes_;
  cl::Buffer buffer_;
};

}  // namespace facezip::test
