#include "device/strided_copy.hpp"

#include <cassert>

#include "device/pooled_buffer.hpp"

namespace facezip::device {
namespace {

/// Rectangles of bytes, as OpenCL takes them: a piece is a row.
struct Rectangle {
  cl::array<cl::size_type, 3> origin;
  cl::array<cl::size_type, 3> host_origin;
  cl::array<cl::size_type, 3> region;
  std::size_t pitch;
  std::size_t host_pitch;
};

Rectangle rectangleOf(const DeviceContext& context, const cl::Buffer& buffer, const Strided& pieces,
                      [[maybe_unused]] std::size_t values) {
  assert(values == pieces.pieces * pieces.length && pieces.length <= pieces.stride);
  const std::size_t end = pieces.first + (pieces.pieces - 1) * pieces.stride + pieces.length;
  requireBytes(context, buffer, end * sizeof(float), "a strided copy");
  // The first piece begins within a row of the rectangle, so that no row reaches beyond the buffer.
  const std::size_t row = pieces.first / pieces.stride;
  const std::size_t column = pieces.first % pieces.stride;
  return {{column * sizeof(float), row, 0},
          {0, 0, 0},
          {pieces.length * sizeof(float), pieces.pieces, 1},
          pieces.stride * sizeof(float),
          pieces.length * sizeof(float)};
}

}  // namespace

void readStrided(const DeviceContext& context, const cl::Buffer& buffer, const Strided& pieces,
                 std::span<float> values) {
  if (values.empty()) return;
  const Rectangle r = rectangleOf(context, buffer, pieces, values.size());
  try {
    context.queue().enqueueReadBufferRect(buffer, CL_TRUE, r.origin, r.host_origin, r.region, r.pitch, 0, r.host_pitch,
                                          0, values.data());
  } catch (const cl::Error& error) {
    throw toDeviceError(error, "reading pieces of a buffer", context.info());
  }
}

void writeStrided(const DeviceContext& context, const cl::Buffer& buffer, const Strided& pieces,
                  std::span<const float> values) {
  if (values.empty()) return;
  const Rectangle r = rectangleOf(context, buffer, pieces, values.size());
  try {
    context.queue().enqueueWriteBufferRect(buffer, CL_TRUE, r.origin, r.host_origin, r.region, r.pitch, 0, r.host_pitch,
                                           0, values.data());
  } catch (const cl::Error& error) {
    throw toDeviceError(error, "writing pieces of a buffer", context.info());
  }
}

}  // namespace facezip::device
