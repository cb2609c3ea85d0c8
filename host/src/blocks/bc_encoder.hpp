// bc_encoder.hpp - BC1, BC4, BC5 and BC7 blocks, made on the device (kernels bc1_encode, bc4_encode, bc7_encode).
#pragma once

#include "blocks/block_encoder.hpp"
#include "blocks/texel_layout.hpp"
#include "device/pooled_buffer.hpp"

namespace facezip::blocks {

/// Texels in device memory; units as TexelRows has them.
struct DeviceTexels {
  TexelLayout layout;
  cl::Buffer samples;
  bool bytes = false;  ///< samples are uint8, else float
  /// float, [y][x] of the picture or [tile][256]; a null buffer: 1 everywhere.
  cl::Buffer weights = {};
};

class BcEncoder final : public BlockEncoder {
 public:
  /// Throws InputError as makeBlockEncoder() does. options.format is one of the BC formats.
  BcEncoder(device::DeviceContext& context, const EncoderOptions& options,
            device::KernelVariant variant = device::KernelVariant::kAuto);

  void encode(const TexelRows& texels, std::span<std::byte> blocks, std::span<float> decoded) override;

  /// The same from device memory into device memory; does not wait.
  /// blocks   [block row][block column], blockBytes() of the layout's width and rows
  /// decoded  float, laid out as texels.samples are; a null buffer if not wanted. May be texels.samples itself
  /// Throws DeviceError, also when a buffer is too small.
  void encodeOnDevice(const DeviceTexels& texels, const cl::Buffer& blocks, const cl::Buffer& decoded);

  /// Writes the block of a constant colour all over `blocks`: what tiles that are not listed shall have. Does not wait.
  /// colour  one value a channel, code units
  void fill(const cl::Buffer& blocks, int width, int rows, std::span<const float> colour);

 private:
  std::string defines(const DeviceTexels& texels, bool decoded) const;

  device::DeviceContext& context_;
  EncoderOptions options_;
  bool gpu_;
  device::PooledBuffer samples_;
  device::PooledBuffer weights_;
  device::PooledBuffer blocks_;
  device::PooledBuffer decoded_;
};

}  // namespace facezip::blocks
