// blend.hpp - problem of the step `blend`: frames of one map from a hash.
#pragma once

#include <algorithm>
#include <cstring>
#include <ostream>
#include <vector>

#include "blend/blend.hpp"
#include "problems/guarded_buffer.hpp"
#include "problems/hashed.hpp"
#include "reference/blend.hpp"

namespace facezip::test {

struct BlendSizes {
  int width = 0;
  int height = 0;
  int channels = 3;
  int differences = 4;  ///< C
  int weight_scale = 8;
  image::SampleType type = image::SampleType::kUint8;
  int difference_bits = 8;
  bool wide_neutral = false;  ///< of 16 bits, beside frames of 8
};

inline void PrintTo(const BlendSizes& sizes, std::ostream* out) {
  *out << sizes.width << "x" << sizes.height << " channels " << sizes.channels << " C " << sizes.differences << " s "
       << sizes.weight_scale << " " << image::sampleTypeName(sizes.type) << " differences in " << sizes.difference_bits
       << " bits" << (sizes.wide_neutral ? ", neutral in 16" : "");
}

/// Must move: the neutral and C differences in, the frame out.
struct BlendProblem {
  explicit BlendProblem(device::DeviceContext& device, const BlendSizes& problem_sizes,
                        device::KernelVariant kernel_variant = device::KernelVariant::kAuto)
      : context(device),
        sizes(problem_sizes),
        variant(kernel_variant),
        grid(raster::WeightGrid::over(sizes.width, sizes.height, sizes.weight_scale)) {
    Hashed hashed(11);
    makeNeutral(hashed);
    for (int i = 0; i < sizes.differences; ++i) makeDifference(hashed, i);
    for (std::size_t q = 0; q < grid.cellCount() * toSize(sizes.differences); ++q) {
      weights.push_back(hashed.between(-1.0f, 1.0f));
    }
  }

  double fullScale() const {
    return sizes.type == image::SampleType::kUint8 ? 255 : sizes.type == image::SampleType::kUint16 ? 65535 : 1;
  }
  image::SampleType neutralType() const { return sizes.wide_neutral ? image::SampleType::kUint16 : sizes.type; }
  std::size_t samples() const { return toSize(sizes.height, sizes.width, sizes.channels); }
  blend::TextureShape shape() const {
    return {sizes.width,           sizes.channels, sizes.differences,
            sizes.difference_bits, sizes.type,     neutralType(),
            sizes.weight_scale,    scale,          zero};
  }

  /// As weight_blend leaves them, times `factor`.
  cl::Buffer uploadWeights(float factor = 1.0f) const {
    constexpr std::size_t kBlock = blend::WeightCodes::kBlockCells;
    const Layout blocks(divideUp(grid.cellCount(), kBlock), sizes.differences, kBlock);
    std::vector<float> values(blocks.size(), 0.0f);
    for (std::size_t cell = 0; cell < grid.cellCount(); ++cell) {
      for (int i = 0; i < sizes.differences; ++i) {
        values[blocks(cell / kBlock, i, cell % kBlock)] =
            factor * weights[cell * toSize(sizes.differences) + toSize(i)];
      }
    }
    return context.upload(values, "weights");
  }

  /// Rows [begin, end) on the device.
  blend::TextureRows load(int begin, int end) const {
    blend::TextureRows rows(context, shape(), end - begin, grid.columns, grid.rows, variant);
    rows.setRows(begin, end);
    const std::size_t first = toSize(begin, sizes.width, sizes.channels);
    const std::size_t count = toSize(end - begin, sizes.width, sizes.channels);
    std::vector<std::span<const std::byte>> differences;
    const std::size_t code_bytes = toSize(sizes.difference_bits / 8);
    for (const std::vector<std::byte>& codes : difference_codes) {
      differences.push_back(std::span(codes).subspan(first * code_bytes, count * code_bytes));
    }
    const std::size_t bytes = image::sampleBytes(neutralType());
    rows.load(begin, end - begin, std::span(neutral).subspan(first * bytes, count * bytes), differences);
    return rows;
  }

  /// Frames of rows [begin, end) as a caller gets them. Throws where a kernel wrote past the caller's memory.
  std::vector<std::byte> blendRows(int begin, int end, float factor = 1.0f) const {
    const std::size_t bytes = toSize(end - begin, sizes.width, sizes.channels) * image::sampleBytes(sizes.type);
    std::vector<std::byte> frame(bytes + kGuard, kFill);
    load(begin, end).blend(uploadWeights(factor), std::span(frame).first(bytes));
    return guarded(std::move(frame));
  }
  /// The same before rounding.
  std::vector<float> blendValues(int begin, int end, float factor = 1.0f) const {
    const std::size_t count = toSize(end - begin, sizes.width, sizes.channels);
    std::vector<float> values(count + kGuard / sizeof(float));
    const std::span<std::byte> all = std::as_writable_bytes(std::span(values));
    std::ranges::fill(all, kFill);
    load(begin, end).blendValues(uploadWeights(factor), std::span(values).first(count));
    guarded({all.begin(), all.end()});
    values.resize(count);
    return values;
  }
  /// Of the whole map: [height][width][channels] samples before rounding and clamping.
  std::vector<double> expected() const {
    reference::Textures textures{
        sizes.width, sizes.height, sizes.channels, sizes.differences, sizes.weight_scale, fullScale(),
        {},          {},           code_scale,     code_offset};
    for (std::size_t s = 0; s < samples(); ++s) textures.neutral.push_back(neutralAt(s));
    for (const std::vector<std::byte>& stored : difference_codes) {
      std::vector<double>& numbers = textures.codes.emplace_back();
      for (std::size_t s = 0; s < samples(); ++s) {
        std::uint16_t code = std::to_integer<std::uint16_t>(stored[s]);
        if (sizes.difference_bits == 16) std::memcpy(&code, stored.data() + 2 * s, 2);
        numbers.push_back(code);
      }
    }
    return reference::blendFrame(textures, {weights.begin(), weights.end()}, grid.columns, grid.rows);
  }

  double sampleAt(const std::vector<std::byte>& frame, std::size_t sample) const {
    if (sizes.type == image::SampleType::kUint8) return std::to_integer<int>(frame[sample]);
    if (sizes.type == image::SampleType::kUint16) {
      std::uint16_t value;
      std::memcpy(&value, frame.data() + 2 * sample, 2);
      return value;
    }
    float value;
    std::memcpy(&value, frame.data() + 4 * sample, 4);
    return static_cast<double>(value);
  }

  /// In samples of a frame.
  double neutralAt(std::size_t sample) const {
    if (!sizes.wide_neutral) return sampleAt(neutral, sample);
    std::uint16_t value;
    std::memcpy(&value, neutral.data() + 2 * sample, 2);
    return value / 257.0;
  }

  double bytes() const {
    const double rows = sizes.height;
    return rows * (2.0 * static_cast<double>(shape().rowBytes()) +
                   sizes.differences * static_cast<double>(shape().differenceRowBytes()));
  }

  device::DeviceContext& context;
  BlendSizes sizes;
  device::KernelVariant variant;
  raster::WeightGrid grid;
  std::vector<std::byte> neutral;
  std::vector<std::vector<std::byte>> difference_codes;  ///< C, as they are loaded
  std::vector<float> scale;                              ///< [C][channels], steps of a sample a code
  std::vector<float> zero;                               ///< [C][channels], the code that means 0
  std::vector<float> weights;                            ///< [cell][C]
  std::vector<std::vector<double>> code_scale;           ///< [C][channels], as the reference takes them
  std::vector<std::vector<double>> code_offset;

 private:
  static constexpr std::size_t kGuard = 64;
  static constexpr std::byte kFill{0xa5};

  static std::vector<std::byte> guarded(std::vector<std::byte> frame) {
    for (std::size_t b = frame.size() - kGuard; b < frame.size(); ++b) {
      if (frame[b] != kFill) throw std::logic_error("written past the frame");
    }
    frame.resize(frame.size() - kGuard);
    return frame;
  }

  void makeNeutral(Hashed& hashed) {
    neutral.resize(samples() * image::sampleBytes(neutralType()));
    hashed.fill(neutral);
    if (sizes.type == image::SampleType::kFloat32) {
      for (std::size_t s = 0; s < samples(); ++s) {
        const float value = s % 5 == 0 ? -0.0f : hashed.between(-0.5f, 1.5f);
        std::memcpy(neutral.data() + s * sizeof(value), &value, sizeof(value));
      }
    }
  }

  /// Codes of texture `i`, whose differences span as much in 16 bits as in 8.
  void makeDifference(Hashed& hashed, int i) {
    const int codes_per_step = sizes.difference_bits == 16 ? 256 : 1;
    std::vector<std::byte>& stored = difference_codes.emplace_back(samples() * toSize(sizes.difference_bits / 8));
    hashed.fill(stored);
    code_scale.emplace_back();
    code_offset.emplace_back();
    for (int c = 0; c < sizes.channels; ++c) {
      const int zero_code = (128 - 15 * i + c) * codes_per_step;
      code_scale.back().push_back((0.5 + 0.11 * i + 0.07 * c) / codes_per_step);
      code_offset.back().push_back(-code_scale.back().back() * zero_code);
      scale.push_back(static_cast<float>(code_scale.back().back() * fullScale() / 255));
      zero.push_back(static_cast<float>(zero_code));
    }
  }
};

}  // namespace facezip::test
