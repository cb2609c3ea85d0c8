#include "device/pooled_buffer.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace facezip::device {

MappedBytes::MappedBytes(const DeviceContext& context, const cl::Buffer& buffer, std::size_t bytes,
                         std::string_view what)
    : context_(context), buffer_(buffer) {
  if (bytes == 0) return;  // OpenCL maps no empty region
  try {
    void* data = context_.queue().enqueueMapBuffer(buffer_, CL_TRUE, CL_MAP_READ, 0, bytes);
    bytes_ = {static_cast<std::byte*>(data), bytes};
  } catch (const cl::Error& error) {
    throw toDeviceError(error, fmt::format("mapping {}", what), context_.info());
  }
}

MappedBytes::~MappedBytes() {
  if (bytes_.empty()) return;
  try {
    context_.queue().enqueueUnmapMemObject(buffer_, bytes_.data());
  } catch (const cl::Error&) {
    // A destructor must not throw; a device that is lost says so in the next call.
  }
}

const cl::Buffer& PooledBuffer::reserve(std::size_t bytes) {
  if (bytes > bytes_ || buffer_() == nullptr) {
    const std::size_t room =
        std::clamp(bytes_ + bytes_ / 2, bytes, std::max(bytes, context_.info().largest_allocation_bytes));
    buffer_ = cl::Buffer();  // first, so that the old and the new one need not both fit
    bytes_ = 0;
    buffer_ = context_.allocate(room, flags_, what_);
    bytes_ = room;
  }
  return buffer_;
}

MappedBytes PooledBuffer::mapForReading(std::size_t bytes) {
  requireBytes(context_, buffer_, bytes, what_);
  return {context_, buffer_, bytes, what_};
}

void requireBytes(const DeviceContext& context, const cl::Buffer& buffer, std::size_t bytes, std::string_view what) {
  const std::size_t has = buffer() == nullptr ? 0 : buffer.getInfo<CL_MEM_SIZE>();
  if (has < bytes) {
    throw DeviceError(fmt::format("checking {}", what), CL_INVALID_BUFFER_SIZE,
                      fmt::format("{} bytes are needed, the buffer on {} has {}", bytes, context.info().name, has));
  }
}

}  // namespace facezip::device
