#include "blocks/bc_encoder.hpp"

#include <fmt/format.h>

#include <cassert>
#include <cstring>
#include <vector>

#include "cl/layout.h"

namespace facezip::blocks {
namespace {

struct Kernel {
  const char* file;
  const char* name;
};

Kernel kernelOf(BlockFormat format) {
  switch (format) {
    case BlockFormat::kBc1:
      return {"bc1_encode.cl", "bc1_encode"};
    case BlockFormat::kBc4:
    case BlockFormat::kBc5:
      return {"bc4_encode.cl", "bc4_encode"};
    default:
      return {"bc7_encode.cl", "bc7_encode"};
  }
}

/// What the kernels' own words for effort are; docs/block_formats.md has what each gains and costs.
std::string effort(BlockFormat format, Quality quality) {
  if (format == BlockFormat::kBc7) {
    if (quality == Quality::kFast) return "-D KEPT=2 -D ROUNDS=1";
    if (quality == Quality::kNormal) return "-D KEPT=4 -D ROUNDS=2";
    return "-D KEPT=12 -D SCAN3=64 -D ROUNDS=2 -D SWEEPS=1 -D DOUBT=0.7f";
  }
  if (quality == Quality::kFast) return "-D ROUNDS=2 -D SWEEPS=0";
  if (quality == Quality::kNormal) return "-D ROUNDS=2 -D SWEEPS=1 -D STARTS=2";
  return "-D ROUNDS=2 -D SWEEPS=3 -D STARTS=4";
}

}  // namespace

BcEncoder::BcEncoder(device::DeviceContext& context, const EncoderOptions& options, device::KernelVariant variant)
    : context_(context),
      options_(options),
      gpu_(context.resolve(variant) == device::KernelVariant::kGpu),
      samples_(context, "texels to code as blocks", CL_MEM_READ_ONLY),
      weights_(context, "weights of texels to code as blocks", CL_MEM_READ_ONLY),
      blocks_(context, "blocks"),
      decoded_(context, "decoded blocks") {
  requireChannels(options.format, options.channels);
  assert(!isAstc(options.format));
}

std::string BcEncoder::defines(const DeviceTexels& texels, bool decoded) const {
  return fmt::format("-D LANES={} -D CHANNELS={} -D TEXEL={} {}{}{}{}", gpu_ ? 1 : 16, options_.channels,
                     texels.bytes ? "uchar" : "float", effort(options_.format, options_.quality),
                     texels.layout.tiled() ? " -D TILES" : "", texels.weights() != nullptr ? " -D TEXEL_WEIGHTS" : "",
                     decoded ? " -D DECODED" : "");
}

void BcEncoder::encodeOnDevice(const DeviceTexels& texels, const cl::Buffer& blocks, const cl::Buffer& decoded) {
  const TexelLayout& layout = texels.layout;
  const KernelLayout places = kernelLayout(layout);
  if (places.blocks == 0) return;
  const std::size_t samples = layout.end(options_.channels);
  device::requireBytes(context_, texels.samples, samples * (texels.bytes ? 1 : sizeof(float)), "texels to code");
  device::requireBytes(context_, blocks, blockBytes(options_.format, layout.width, layout.rows), "blocks");
  if (decoded() != nullptr) device::requireBytes(context_, decoded, samples * sizeof(float), "decoded blocks");
  if (texels.weights() != nullptr) {
    const std::size_t weights = layout.tiled()
                                    ? layout.tile_count * kTileTexels
                                    : static_cast<std::size_t>(layout.width) * static_cast<std::size_t>(layout.rows);
    device::requireBytes(context_, texels.weights, weights * sizeof(float), "weights of texels to code");
  }
  const Kernel which = kernelOf(options_.format);
  const cl::Kernel kernel = context_.kernel(which.file, which.name, defines(texels, decoded() != nullptr));
  // Buffers that a kernel does not touch are another's: null ones are not taken by every driver.
  const auto orOther = [&](const cl::Buffer& buffer) { return buffer() != nullptr ? buffer : texels.samples; };
  const std::array<float, 4>& scale = options_.channel_weights;
  const std::size_t lanes = gpu_ ? 1 : FACEZIP_VECTOR;
  // Single work-items on CPUs: one has 16 blocks, and all of a core's registers.
  const std::size_t local = gpu_ ? context_.workGroupSize(kernel, 64) : 1;
  const std::size_t items = roundUp(divideUp(std::size_t{places.blocks}, lanes), local);
  context_.launch(kernel, device::WorkItems(items).inGroupsOf(local), places, orOther(layout.tiles), texels.samples,
                  orOther(texels.weights), cl_float4{{scale[0], scale[1], scale[2], scale[3]}}, blocks,
                  orOther(decoded));
}

void BcEncoder::encode(const TexelRows& texels, std::span<std::byte> blocks, std::span<float> decoded) {
  assert(texels.channels == options_.channels);
  assert(blocks.size() == blockBytes(options_.format, texels.width, texels.rows));
  const std::size_t texel_count = static_cast<std::size_t>(texels.width) * static_cast<std::size_t>(texels.rows);
  [[maybe_unused]] const std::size_t samples = texel_count * static_cast<std::size_t>(texels.channels);
  assert(decoded.empty() || decoded.size() == samples);
  assert(texels.weights.empty() || texels.weights.size() == texel_count);
  DeviceTexels on_device;
  on_device.layout = TexelLayout::interleaved(texels.width, texels.rows, texels.channels);
  on_device.bytes = std::holds_alternative<std::span<const std::uint8_t>>(texels.samples);
  on_device.samples = std::visit([this](auto span) { return samples_.upload(span); }, texels.samples);
  if (!texels.weights.empty()) on_device.weights = weights_.upload(texels.weights);
  blocks_.reserve(blocks.size());
  if (!decoded.empty()) decoded_.reserve(decoded.size_bytes());
  encodeOnDevice(on_device, blocks_.buffer(), decoded.empty() ? cl::Buffer() : decoded_.buffer());
  context_.read(blocks_.buffer(), blocks, "blocks");
  if (!decoded.empty()) context_.read(decoded_.buffer(), decoded, "decoded blocks");
}

void BcEncoder::fill(const cl::Buffer& blocks, int width, int rows, std::span<const float> colour) {
  assert(colour.size() == static_cast<std::size_t>(options_.channels));
  std::vector<float> texels;
  for (int t = 0; t < 16; ++t) texels.insert(texels.end(), colour.begin(), colour.end());
  std::array<std::byte, 16> block;
  const auto block_bytes = static_cast<std::size_t>(infoOf(options_.format).block_bytes);
  encode(
      {.width = 4, .rows = 4, .channels = options_.channels, .samples = std::span<const float>(texels), .weights = {}},
      std::span(block).first(block_bytes), {});
  const std::size_t bytes = blockBytes(options_.format, width, rows);
  device::requireBytes(context_, blocks, bytes, "blocks");
  try {
    if (block_bytes == 8) {
      cl_ulong pattern;
      std::memcpy(&pattern, block.data(), sizeof(pattern));
      context_.queue().enqueueFillBuffer(blocks, pattern, 0, bytes);
    } else {
      cl_ulong2 pattern;
      std::memcpy(&pattern, block.data(), sizeof(pattern));
      context_.queue().enqueueFillBuffer(blocks, pattern, 0, bytes);
    }
  } catch (const cl::Error& error) {
    throw device::toDeviceError(error, "filling blocks", context_.info());
  }
}

}  // namespace facezip::blocks
