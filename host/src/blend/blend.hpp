// blend.hpp - textures of one map on a device in tiles, and frames blended from them (Eq. 8).
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "blend/weight_blend.hpp"
#include "cl/layout.h"
#include "device/device_context.hpp"
#include "image/image_file.hpp"
#include "io/counts.hpp"

namespace facezip::blend {

inline constexpr int kTileWidth = FACEZIP_TILE_SIDE;       ///< texels, kernels/cl/blend.cl
inline constexpr int kTileRows = FACEZIP_BLEND_TILE_ROWS;  ///< texels

/// What the kernel writes: samples of the frame's type, or float32 in 1/255 of full scale, before rounding.
enum class FrameForm { kSamples, kValues };

/// What a map's textures are, for the kernel.
struct TextureShape {
  int width = 0;                                               ///< texels
  int channels = 0;                                            ///< 1 to 4
  int differences = 0;                                         ///< C, 1 to 8
  int difference_bits = 8;                                     ///< of a code: 8 or 16
  image::SampleType sample_type = image::SampleType::kUint8;   ///< of a frame
  image::SampleType neutral_type = image::SampleType::kUint8;  ///< of the neutral: that, or 16 bits for frames of 8
  int weight_scale = 0;                                        ///< s
  std::vector<float>
      scale;  ///< [C][channels], steps of a sample (8-bit 1, 16-bit 1/257 and float 255 in 1/255) per code
  std::vector<float> zero;  ///< [C][channels], the code that means 0

  int tilesAcross() const { return divideUp(width, kTileWidth); }
  std::size_t rowBytes() const { return frameShape(1).rowBytes(); }  ///< of a frame
  std::size_t neutralRowBytes() const { return toSize(width, channels) * image::sampleBytes(neutral_type); }
  std::size_t codeBytes() const { return difference_bits == 16 ? 2 : 1; }
  std::size_t differenceRowBytes() const { return toSize(width, channels) * codeBytes(); }
  /// One texel row of one tile: 16 texels of the neutral, and of all differences. A tile has the rows of the one, then
  /// those of the other.
  std::size_t neutralTileRowBytes() const;
  std::size_t codeTileRowBytes() const;
  std::size_t tileBytes() const { return kTileRows * (neutralTileRowBytes() + codeTileRowBytes()); }
  /// A row of tiles.
  std::size_t tilesBytes() const { return toSize(tilesAcross()) * tileBytes(); }
  image::ImageShape frameShape(int rows) const { return {width, rows, channels, sample_type}; }
};

/// The device side of kernels/cl/blend.cl: rows [begin, end) of a map.
class TextureRows {
 public:
  /// Allocates for `most_rows` rows. cell_columns, cell_rows: size of the weight grid. Throws DeviceError.
  TextureRows(device::DeviceContext& context, TextureShape shape, int most_rows, int cell_columns, int cell_rows,
              device::KernelVariant variant = device::KernelVariant::kAuto);

  const TextureShape& shape() const { return shape_; }
  int begin() const { return begin_; }
  int end() const { return end_; }

  /// From now on rows [begin, end) are held; begin is a multiple of kTileRows.
  void setRows(int begin, int end);

  /// Puts rows [first, first + rows) into tiles; first a multiple of kTileRows, rows too or up to end().
  /// neutral      rows x neutralRowBytes()
  /// differences  C spans of rows x differenceRowBytes()
  void load(int first, int rows, std::span<const std::byte> neutral,
            std::span<const std::span<const std::byte>> differences);

  /// Blends rows [begin(), end()) into `out`, (end - begin) x rowBytes() bytes, and waits.
  /// weights  [blocks][C][16] float, WeightMaps::weights()
  void blend(const cl::Buffer& weights, std::span<std::byte> out);

  /// The same before rounding: float32 in units of 1/255 of full scale, neither rounded nor clamped.
  /// out  (end - begin) x width x channels
  void blendValues(const cl::Buffer& weights, std::span<float> out);

  /// Runs the kernel into `frame`, frameBytes() bytes whose rows are padded to whole tiles; for blend() and benchmarks.
  cl::Event enqueue(const cl::Buffer& weights, const cl::Buffer& frame, FrameForm form = FrameForm::kSamples);
  std::size_t frameBytes(FrameForm form = FrameForm::kSamples) const {
    return toSize(tileRowCount()) * kTileRows * paddedRowBytes(form);
  }
  std::size_t paddedRowBytes(FrameForm form = FrameForm::kSamples) const;

 private:
  /// The kernel that writes one form, and memory for what it writes.
  struct Output {
    cl::Kernel kernel;
    std::size_t local_size = 0;
    cl::Buffer frame;  // that is copied out
  };

  int tileRowCount() const { return (end_ - begin_ + kTileRows - 1) / kTileRows; }
  std::size_t frameSampleBytes(FrameForm form) const;
  Output& output(FrameForm form);
  cl::Buffer allocateFrame(FrameForm form) const;
  /// Planes of codes, of a channel and a difference each, that are stored in quads (kernels/cl/blend.cl).
  int quadPlanes() const;
  bool fitsFrame(std::span<const std::byte> out, FrameForm form) const;
  void blendInto(const cl::Buffer& weights, std::span<std::byte> out, FrameForm form);

  device::DeviceContext& context_;
  TextureShape shape_;
  int cell_columns_;
  int cell_rows_;
  int begin_ = 0;
  int end_ = 0;
  bool gpu_;
  bool clang_builtins_;
  Output outputs_[2];  // by FrameForm; the second is made when values are first asked for
  cl::Buffer textures_;
  cl::Buffer encoding_;
  std::size_t most_rows_;
  std::vector<std::byte> tiles_;  // staging of load()
};

}  // namespace facezip::blend
