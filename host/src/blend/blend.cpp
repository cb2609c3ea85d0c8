#include "blend/blend.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cassert>
#include <cstdint>
#include <cstring>

namespace facezip::blend {
namespace {

/// Where 16 texels of one plane lie in a tile's row: in samples or codes from `begin`, texel x of quad x / 4.
struct Plane {
  std::size_t begin;
  std::size_t quad_stride;  // 4: one texel behind the other
};

Plane neutralPlane(int channel) { return {toSize(channel) * kTileWidth, 4}; }

/// As kernels/cl/blend.cl describes it.
Plane codePlane(const TextureShape& shape, int quad_planes, int channel, int difference) {
  const std::size_t plane = toSize(channel, shape.differences) + toSize(difference);
  if (plane >= toSize(quad_planes)) return {plane * kTileWidth, 4};
  return {plane / 4 * 4 * kTileWidth + plane % 4 * 4, 16};
}

/// Takes one channel out of an interleaved row of texels and puts it into its plane in each tile.
/// Texels beyond the width keep what was there; the frame's padding is never read.
template <typename Sample>
void splitRow(const std::byte* row, const TextureShape& shape, int channel, Plane plane, std::byte* to) {
  const std::size_t tile_bytes = shape.tileBytes();
  const std::size_t texel_bytes = toSize(shape.channels) * sizeof(Sample);
  row += toSize(channel) * sizeof(Sample);
  for (std::size_t x0 = 0; x0 < toSize(shape.width); x0 += kTileWidth) {
    const std::size_t count = std::min<std::size_t>(kTileWidth, toSize(shape.width) - x0);
    for (std::size_t x = 0; x < count; ++x) {
      const std::size_t in_plane = plane.begin + x / 4 * plane.quad_stride + x % 4;
      std::memcpy(to + in_plane * sizeof(Sample), row + (x0 + x) * texel_bytes, sizeof(Sample));
    }
    to += tile_bytes;
  }
}

/// splitRow for samples or codes of `bytes` bytes.
void splitRowOf(std::size_t bytes, const TextureShape& shape, const std::byte* row, int channel, Plane plane,
                std::byte* to) {
  switch (bytes) {
    case 1:
      return splitRow<std::uint8_t>(row, shape, channel, plane, to);
    case 2:
      return splitRow<std::uint16_t>(row, shape, channel, plane, to);
    default:
      return splitRow<float>(row, shape, channel, plane, to);
  }
}

/// The kernel's third row of `encoding` takes back the bias that codes in quads come with.
std::vector<float> encodingOf(const TextureShape& shape, int quad_planes) {
  constexpr double kCodeBias{FACEZIP_CODE_BIAS};
  std::vector<float> encoding = shape.scale;
  encoding.insert(encoding.end(), shape.zero.begin(), shape.zero.end());
  for (int i = 0; i < shape.differences; ++i) {
    for (int c = 0; c < shape.channels; ++c) {
      const std::size_t plane = toSize(i * shape.channels + c);
      const bool biased = c * shape.differences + i < quad_planes;
      encoding.push_back(
          static_cast<float>(-double{shape.scale[plane]} * (double{shape.zero[plane]} + (biased ? kCodeBias : 0.0))));
    }
  }
  return encoding;
}

std::string definesOf(const TextureShape& shape, int quad_planes, bool gpu, bool clang_builtins, FrameForm form) {
  return fmt::format(
      "-D LANES={} -D CHANNELS={} -D DIFFERENCES={} -D SCALE={} -D SAMPLE_TYPE={} -D NEUTRAL_TYPE={} -D CODE_BITS={} "
      "-D QUAD_PLANES={} -D VALUES={} -D CLANG_BUILTINS={}",
      gpu ? 1 : kTileWidth, shape.channels, shape.differences, shape.weight_scale, static_cast<int>(shape.sample_type),
      static_cast<int>(shape.neutral_type), shape.difference_bits, quad_planes, form == FrameForm::kValues ? 1 : 0,
      clang_builtins ? 1 : 0);
}

}  // namespace

std::size_t TextureShape::neutralTileRowBytes() const {
  return toSize(channels) * image::sampleBytes(neutral_type) * kTileWidth;
}

std::size_t TextureShape::codeTileRowBytes() const { return toSize(channels, differences) * codeBytes() * kTileWidth; }

TextureRows::TextureRows(device::DeviceContext& context, TextureShape shape, int most_rows, int cell_columns,
                         int cell_rows, device::KernelVariant variant)
    : context_(context),
      shape_(std::move(shape)),
      cell_columns_(cell_columns),
      cell_rows_(cell_rows),
      most_rows_(roundUp(toSize(most_rows), kTileRows)) {
  assert(shape_.scale.size() == toSize(shape_.differences, shape_.channels));
  assert(shape_.zero.size() == shape_.scale.size());
  gpu_ = context.resolve(variant) == device::KernelVariant::kGpu;
  clang_builtins_ = context.clangBuiltins(variant);
  textures_ = context.allocate(most_rows_ / kTileRows * shape_.tilesBytes(), CL_MEM_READ_ONLY, "the textures of a map");
  encoding_ = context.upload(encodingOf(shape_, quadPlanes()), "the encoding of difference textures");
  // Frames take no memory of their own, not even the first.
  output(FrameForm::kSamples).frame = allocateFrame(FrameForm::kSamples);
}

cl::Buffer TextureRows::allocateFrame(FrameForm form) const {
  return context_.allocate(most_rows_ * paddedRowBytes(form), CL_MEM_WRITE_ONLY | CL_MEM_ALLOC_HOST_PTR, "a frame");
}

int TextureRows::quadPlanes() const {
  const bool narrow = shape_.sample_type == image::SampleType::kUint8 && shape_.neutral_type == shape_.sample_type &&
                      shape_.difference_bits == 8;
  return clang_builtins_ && narrow ? shape_.channels * shape_.differences / 4 * 4 : 0;
}

TextureRows::Output& TextureRows::output(FrameForm form) {
  Output& output = outputs_[static_cast<std::size_t>(form)];
  if (output.kernel() == nullptr) {
    output.kernel = context_.kernel("blend.cl", "blend", definesOf(shape_, quadPlanes(), gpu_, clang_builtins_, form));
    output.local_size = context_.workGroupSize(output.kernel, gpu_ ? 64 : 16);
  }
  return output;
}

void TextureRows::setRows(int begin, int end) {
  assert(begin % kTileRows == 0 && begin < end && toSize(end - begin) <= most_rows_);
  begin_ = begin;
  end_ = end;
}

void TextureRows::load(int first, int rows, std::span<const std::byte> neutral,
                       std::span<const std::span<const std::byte>> differences) {
  assert(first % kTileRows == 0 && begin_ <= first && first + rows <= end_);
  assert(neutral.size() == toSize(rows) * shape_.neutralRowBytes() && differences.size() == toSize(shape_.differences));
  const int tile_rows = (rows + kTileRows - 1) / kTileRows;
  const std::size_t sample_bytes = image::sampleBytes(shape_.neutral_type);
  const std::size_t code_bytes = shape_.codeBytes();
  tiles_.resize(toSize(tile_rows) * shape_.tilesBytes());
  tbb::parallel_for(0, rows, [&](int row) {
    std::byte* tiles = tiles_.data() + toSize(row / kTileRows) * shape_.tilesBytes();
    std::byte* samples = tiles + toSize(row % kTileRows) * shape_.neutralTileRowBytes();
    std::byte* codes =
        tiles + kTileRows * shape_.neutralTileRowBytes() + toSize(row % kTileRows) * shape_.codeTileRowBytes();
    const std::byte* neutral_row = neutral.data() + toSize(row) * shape_.neutralRowBytes();
    for (int c = 0; c < shape_.channels; ++c) {
      splitRowOf(sample_bytes, shape_, neutral_row, c, neutralPlane(c), samples);
      for (int i = 0; i < shape_.differences; ++i) {
        const std::byte* code_row = differences[toSize(i)].data() + toSize(row) * shape_.differenceRowBytes();
        splitRowOf(code_bytes, shape_, code_row, c, codePlane(shape_, quadPlanes(), c, i), codes);
      }
    }
  });
  context_.write(textures_, tiles_, "the textures of a map",
                 toSize((first - begin_) / kTileRows) * shape_.tilesBytes());
}

std::size_t TextureRows::frameSampleBytes(FrameForm form) const {
  return form == FrameForm::kValues ? sizeof(float) : image::sampleBytes(shape_.sample_type);
}

std::size_t TextureRows::paddedRowBytes(FrameForm form) const {
  return toSize(shape_.tilesAcross()) * kTileWidth * toSize(shape_.channels) * frameSampleBytes(form);
}

cl::Event TextureRows::enqueue(const cl::Buffer& weights, const cl::Buffer& frame, FrameForm form) {
  auto& [kernel, local_size, unused] = output(form);
  const std::size_t tiles = toSize(tileRowCount()) * toSize(shape_.tilesAcross());
  const std::size_t items = tiles * (gpu_ ? kTileWidth : 1);
  return context_.launch(kernel, device::WorkItems(roundUp(items, local_size)).inGroupsOf(local_size), textures_,
                         weights, encoding_, frame, shape_.tilesAcross(), tiles, begin_ / kTileRows, cell_columns_,
                         cell_rows_);
}

/// True when the kernel may write into the caller's memory: no padding in the frame, vector stores aligned, and a
/// device that shares the host's memory.
bool TextureRows::fitsFrame(std::span<const std::byte> out, FrameForm form) const {
  constexpr std::size_t kWidestStore = 64;  // float16 and uint16; three 8-bit channels go out in uchar16
  const bool narrow = shape_.channels == 3 && frameSampleBytes(form) == 1;
  const std::size_t alignment = narrow ? kTileWidth : kWidestStore;
  return context_.info().type == DeviceInfo::Type::kCpu && out.size() == frameBytes(form) &&
         reinterpret_cast<std::uintptr_t>(out.data()) % alignment == 0;
}

void TextureRows::blend(const cl::Buffer& weights, std::span<std::byte> out) {
  blendInto(weights, out, FrameForm::kSamples);
}

void TextureRows::blendValues(const cl::Buffer& weights, std::span<float> out) {
  blendInto(weights, std::as_writable_bytes(out), FrameForm::kValues);
}

void TextureRows::blendInto(const cl::Buffer& weights, std::span<std::byte> out, FrameForm form) {
  const std::size_t row_bytes = toSize(shape_.width, shape_.channels) * frameSampleBytes(form);
  assert(out.size() == toSize(end_ - begin_) * row_bytes);
  try {
    if (fitsFrame(out, form)) {
      const cl::Buffer frame(context_.context(), CL_MEM_WRITE_ONLY | CL_MEM_USE_HOST_PTR, out.size(), out.data());
      enqueue(weights, frame, form);
      // Mapping is what makes the result visible at `out`; on a device that shares memory it copies nothing.
      void* mapped = context_.queue().enqueueMapBuffer(frame, CL_TRUE, CL_MAP_READ, 0, out.size());
      context_.queue().enqueueUnmapMemObject(frame, mapped);
      context_.finish();
      return;
    }
    cl::Buffer& frame = output(form).frame;
    const std::size_t padded = paddedRowBytes(form);
    if (frame() == nullptr) frame = allocateFrame(form);
    enqueue(weights, frame, form);
    const void* mapped = context_.queue().enqueueMapBuffer(frame, CL_TRUE, CL_MAP_READ, 0, frameBytes(form));
    for (int row = 0; row < end_ - begin_; ++row) {
      std::memcpy(out.data() + toSize(row) * row_bytes, static_cast<const std::byte*>(mapped) + toSize(row) * padded,
                  row_bytes);
    }
    context_.queue().enqueueUnmapMemObject(frame, const_cast<void*>(mapped));
    context_.finish();
  } catch (const cl::Error& error) {
    throw device::toDeviceError(error, "reading a frame", context_.info());
  }
}

}  // namespace facezip::blend
