// pooled_buffer.hpp - device memory that is kept from band to band.
// Touching a fresh buffer of 256 MB costs PoCL up to half a second in page faults; bands are many and alike.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "device/device_context.hpp"

namespace facezip::device {

/// Host view of a buffer, to read; unmaps when it goes. The device must not use the buffer meanwhile.
class MappedBytes {
 public:
  MappedBytes(const DeviceContext& context, const cl::Buffer& buffer, std::size_t bytes, std::string_view what);
  ~MappedBytes();
  MappedBytes(const MappedBytes&) = delete;
  MappedBytes& operator=(const MappedBytes&) = delete;

  std::span<std::byte> bytes() const { return bytes_; }
  template <typename T>
  std::span<T> as() const {
    return {reinterpret_cast<T*>(bytes_.data()), bytes_.size() / sizeof(T)};
  }

 private:
  const DeviceContext& context_;
  cl::Buffer buffer_;
  std::span<std::byte> bytes_;
};

/// A buffer that only grows, by half at least: bands often grow a little from one to the next, and memory that is not
/// touched costs nothing on PoCL. Its contents are lost when it does.
class PooledBuffer {
 public:
  /// what  names the buffer in errors
  PooledBuffer(const DeviceContext& context, std::string_view what, cl_mem_flags flags = CL_MEM_READ_WRITE)
      : context_(context), what_(what), flags_(flags) {}

  /// Makes room for `bytes` and returns the buffer. Throws DeviceError when the device has no room.
  const cl::Buffer& reserve(std::size_t bytes);

  /// Makes room for `values` and copies them in.
  template <Values R>
  const cl::Buffer& upload(const R& values) {
    const std::span data(values);
    reserve(data.size_bytes());
    context_.write(buffer_, data, what_);
    return buffer_;
  }

  /// Copies the first values.size() values out.
  template <Values R>
  void read(R&& values) const {
    context_.read(buffer_, values, what_);
  }

  /// Maps `bytes` for the host to read.
  MappedBytes mapForReading(std::size_t bytes);

  const cl::Buffer& buffer() const { return buffer_; }

 private:
  const DeviceContext& context_;
  std::string what_;
  cl_mem_flags flags_;
  cl::Buffer buffer_;
  std::size_t bytes_ = 0;
};

/// Throws DeviceError if `buffer` holds fewer than `bytes`; to be asked before a kernel is let loose on it.
void requireBytes(const DeviceContext& context, const cl::Buffer& buffer, std::size_t bytes, std::string_view what);

}  // namespace facezip::device
