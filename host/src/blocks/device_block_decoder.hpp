// device_block_decoder.hpp - the texels of BC blocks, on the device (kernel block_decode).
#pragma once

#include "blocks/block_format.hpp"
#include "blocks/texel_layout.hpp"

namespace facezip::blocks {

enum class DecodedType { kFloat, kUint8 };

/// Decodes blocks of device memory into device memory, in code units 0 to 255; does not wait.
/// format    one of the BC formats
/// channels  of the texture, as makeBlockDecoder() takes them
/// blocks    [block row][block column], blockBytes() of the layout's width and rows
/// texels    laid out as `layout` says
/// Throws DeviceError, also when a buffer is too small.
void decodeOnDevice(device::DeviceContext& context, BlockFormat format, int channels, const cl::Buffer& blocks,
                    const TexelLayout& layout, DecodedType type, const cl::Buffer& texels);

}  // namespace facezip::blocks
