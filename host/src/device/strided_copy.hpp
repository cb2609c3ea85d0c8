// strided_copy.hpp - pieces of a buffer that lie at equal distances, as one array on the host.
#pragma once

#include <cstddef>
#include <span>

#include "device/device_context.hpp"

namespace facezip::device {

/// Counts floats.
struct Strided {
  std::size_t first = 0;   ///< of the first piece
  std::size_t length = 0;  ///< of a piece
  std::size_t stride = 0;  ///< from piece to piece
  std::size_t pieces = 0;
};

/// Both wait. values  exactly pieces * length. Throw DeviceError.
void readStrided(const DeviceContext& context, const cl::Buffer& buffer, const Strided& pieces,
                 std::span<float> values);
void writeStrided(const DeviceContext& context, const cl::Buffer& buffer, const Strided& pieces,
                  std::span<const float> values);

}  // namespace facezip::device
