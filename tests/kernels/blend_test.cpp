#include "blend/blend.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>
#include <vector>

#include "reference/blend.hpp"
#include "test_device.hpp"
#include "tolerances.hpp"

namespace facezip {
namespace {
using device::KernelVariant;
using image::SampleType;

struct BlendCase {
  int width, height, channels, differences, weight_scale;
  SampleType type;
  int difference_bits = 8;
};

void PrintTo(const BlendCase& c, std::ostream* out) {
  *out << c.width << "x" << c.height << " channels " << c.channels << " C " << c.differences << " s " << c.weight_scale
       << " " << image::sampleTypeName(c.type) << " differences in " << c.difference_bits << " bits";
}

/// Random textures and weights, for the kernel and for the reference.
struct Scene {
  explicit Scene(const BlendCase& c, device::DeviceContext& on = test::testDevice()) : size(c), context(on) {
    columns = (c.width + c.weight_scale - 1) / c.weight_scale;
    rows = (c.height + c.weight_scale - 1) / c.weight_scale;
    const std::size_t samples = static_cast<std::size_t>(c.width * c.height * c.channels);
    textures = {c.width, c.height, c.channels, c.differences, c.weight_scale, fullScale(), {}, {}, {}, {}};
    neutral.resize(samples * image::sampleBytes(c.type));
    for (std::size_t s = 0; s < samples; ++s) textures.neutral.push_back(setNeutral(s));
    for (int i = 0; i < c.differences; ++i) addDifference(i, samples);
    for (int q = 0; q < columns * rows * c.differences; ++q)
      weights.push_back(static_cast<float>(random() % 2001) * 1e-3f - 1.0f);
  }

  double fullScale() const {
    return size.type == SampleType::kUint8 ? 255 : size.type == SampleType::kUint16 ? 65535 : 1;
  }

  double setNeutral(std::size_t sample) {
    if (size.type == SampleType::kUint8) {
      const auto value = static_cast<std::uint8_t>(random());
      std::memcpy(neutral.data() + sample, &value, 1);
      return value;
    }
    if (size.type == SampleType::kUint16) {
      const auto value = static_cast<std::uint16_t>(random());
      std::memcpy(neutral.data() + sample * 2, &value, 2);
      return value;
    }
    const float value = sample % 5 == 0 ? -0.0f : static_cast<float>(random() % 2000) * 1e-3f - 0.5f;
    std::memcpy(neutral.data() + sample * 4, &value, 4);
    return static_cast<double>(value);
  }

  /// Random codes of texture `i`, whose differences span as much in 16 bits as in 8.
  void addDifference(int i, std::size_t samples) {
    const int codes_per_step = size.difference_bits == 16 ? 256 : 1;
    std::vector<double>& codes = textures.codes.emplace_back();
    std::vector<std::byte>& stored =
        difference_codes.emplace_back(samples * static_cast<std::size_t>(size.difference_bits / 8));
    for (std::size_t s = 0; s < samples; ++s) {
      const auto code = static_cast<std::uint16_t>(random() % static_cast<unsigned>(256 * codes_per_step));
      codes.push_back(code);
      if (size.difference_bits == 16) {
        std::memcpy(stored.data() + 2 * s, &code, 2);
      } else {
        stored[s] = static_cast<std::byte>(code);
      }
    }
    textures.scale.emplace_back();
    textures.offset.emplace_back();
    for (int c = 0; c < size.channels; ++c) {
      const int zero_code = (128 - 15 * i + c) * codes_per_step;
      textures.scale.back().push_back((0.5 + 0.11 * i + 0.07 * c) / codes_per_step);
      textures.offset.back().push_back(-textures.scale.back().back() * zero_code);
      scale.push_back(static_cast<float>(textures.scale.back().back() * fullScale() / 255));
      zero.push_back(static_cast<float>(zero_code));
    }
  }

  blend::TextureShape shape() const {
    return {size.width, size.channels, size.differences, size.difference_bits, size.type, size.weight_scale,
            scale,      zero};
  }

  cl::Buffer uploadWeights(float factor = 1.0f) const {
    const std::size_t channels = static_cast<std::size_t>(size.differences);
    const std::size_t cells = weights.size() / channels;
    std::vector<float> blocks((cells + 15) / 16 * 16 * channels, 0.0f);
    for (std::size_t q = 0; q < weights.size(); ++q) {
      const std::size_t cell = q / channels;
      blocks[(cell / 16 * channels + q % channels) * 16 + cell % 16] = factor * weights[q];
    }
    return context.upload(blocks, "weights");
  }

  blend::TextureRows load(int begin, int end, KernelVariant variant) const {
    blend::TextureRows textures_on_device(context, shape(), end - begin, columns, rows, variant);
    textures_on_device.setRows(begin, end);
    const std::size_t row_samples = static_cast<std::size_t>(size.width * size.channels);
    const std::size_t first = static_cast<std::size_t>(begin) * row_samples;
    const std::size_t count = static_cast<std::size_t>(end - begin) * row_samples;
    std::vector<std::span<const std::byte>> differences;
    const auto code_bytes = static_cast<std::size_t>(size.difference_bits / 8);
    for (const std::vector<std::byte>& codes : difference_codes)
      differences.push_back(std::span(codes).subspan(first * code_bytes, count * code_bytes));
    const std::size_t bytes = image::sampleBytes(size.type);
    textures_on_device.load(begin, end - begin, std::span(neutral).subspan(first * bytes, count * bytes), differences);
    return textures_on_device;
  }

  std::vector<std::byte> blendRows(int begin, int end, float factor = 1.0f,
                                   KernelVariant variant = KernelVariant::kAuto) const {
    blend::TextureRows on_device = load(begin, end, variant);
    const std::size_t bytes =
        static_cast<std::size_t>((end - begin) * size.width * size.channels) * image::sampleBytes(size.type);
    constexpr std::size_t kCanary = 64;
    std::vector<std::byte> frame(bytes + kCanary, std::byte{0xa5});
    on_device.blend(uploadWeights(factor), std::span(frame).first(bytes));
    for (std::size_t b = bytes; b < frame.size(); ++b) EXPECT_EQ(frame[b], std::byte{0xa5}) << "written past the frame";
    frame.resize(bytes);
    return frame;
  }

  std::vector<float> blendValues(int begin, int end, float factor = 1.0f,
                                 KernelVariant variant = KernelVariant::kAuto) const {
    blend::TextureRows on_device = load(begin, end, variant);
    constexpr std::size_t kCanary = 16;
    std::vector<float> values(static_cast<std::size_t>((end - begin) * size.width * size.channels) + kCanary, -7.5f);
    on_device.blendValues(uploadWeights(factor), std::span(values).first(values.size() - kCanary));
    for (std::size_t s = values.size() - kCanary; s < values.size(); ++s)
      EXPECT_EQ(values[s], -7.5f) << "written past the frame";
    values.resize(values.size() - kCanary);
    return values;
  }

  /// What the bias of codes, where frames have it folded, may add to their error: weights are 1 at most.
  double biasSlack(KernelVariant variant) const {
    if (!context.clangBuiltins(variant) || size.type != SampleType::kUint8 || size.difference_bits != 8) return 0.0;
    double most = 0.0;
    for (std::size_t c = 0; c < static_cast<std::size_t>(size.channels); ++c) {
      double sum = 0.0;
      for (const std::vector<double>& of_texture : textures.scale) sum += of_texture[c];
      most = std::max(most, sum);
    }
    return test::kFoldedCodeBias * most;
  }

  double sampleAt(const std::vector<std::byte>& frame, std::size_t sample) const {
    if (size.type == SampleType::kUint8) return static_cast<double>(frame[sample]);
    if (size.type == SampleType::kUint16) {
      std::uint16_t value;
      std::memcpy(&value, frame.data() + 2 * sample, 2);
      return value;
    }
    float value;
    std::memcpy(&value, frame.data() + 4 * sample, 4);
    return static_cast<double>(value);
  }

  BlendCase size;
  device::DeviceContext& context;
  std::mt19937_64 random{11};
  int columns, rows;
  std::vector<std::byte> neutral;
  std::vector<std::vector<std::byte>> difference_codes;  // C, as they are loaded
  std::vector<float> scale, zero, weights;
  reference::Textures textures;
};

class Blend : public testing::TestWithParam<std::tuple<BlendCase, KernelVariant>> {
 protected:
  void SetUp() override {
    const auto& [size, variant] = GetParam();
    if (test::smallSizesOnly() && (size.width > 50 || size.differences > 5)) GTEST_SKIP() << "large for a simulator";
    // Oclgrind's shadow values of swizzles are read out of bounds when a lane is unused. The arithmetic is seen in the
    // other types, the packing on every other device.
    const bool oclgrind = test::testDevice().info().platform == "Oclgrind";
    if (oclgrind && variant == KernelVariant::kCpu && size.channels == 3 && size.type == SampleType::kUint8) {
      GTEST_SKIP() << "Oclgrind 21.10 --uninitialized crashes on the swizzles that pack RGB8";
    }
  }
};

/// What rounding half up may give where float arithmetic puts the value within `slack` of `exact`.
bool roundsTo(double exact, double full_scale, double slack, double got) {
  const double low = std::clamp(std::floor(exact - slack + 0.5), 0.0, full_scale);
  const double high = std::clamp(std::floor(exact + slack + 0.5), 0.0, full_scale);
  return got >= low && got <= high;
}

void expectAgreement(const Scene& scene, KernelVariant variant) {
  const BlendCase& size = scene.size;
  const std::vector<double> weights(scene.weights.begin(), scene.weights.end());
  const std::vector<double> expected = reference::blendFrame(scene.textures, weights, scene.columns, scene.rows);
  const std::vector<std::byte> frame = scene.blendRows(0, size.height, 1.0f, variant);
  // Terms reach 1.5 of full scale each; float arithmetic loses a few units of 2^-24 in each.
  const double slack = 3e-6 * scene.textures.full_scale + scene.biasSlack(variant);
  for (std::size_t s = 0; s < expected.size(); ++s) {
    const double got = scene.sampleAt(frame, s);
    if (size.type == SampleType::kFloat32) {
      ASSERT_NEAR(got, expected[s], slack) << s;
    } else {
      ASSERT_TRUE(roundsTo(expected[s], scene.textures.full_scale, slack, got))
          << s << ": " << expected[s] << " gave " << got;
    }
  }
}

TEST_P(Blend, AgreesWithTheReference) {
  const auto& [size, variant] = GetParam();
  expectAgreement(Scene(size), variant);
}

/// The device of the tests under another platform's name: kernels keep to OpenCL C.
device::DeviceContext& plainDevice() {
  static device::DeviceContext& context = *[] {
    DeviceInfo info = test::testDevice().info();
    info.platform = "another";
    return new device::DeviceContext(test::testDevice().device(), info);
  }();
  return context;
}

TEST(Blend, NeedsNoBuiltinsOfClang) {
  if (!test::testDevice().clangBuiltins(KernelVariant::kCpu)) GTEST_SKIP() << "nothing else is tested here";
  for (const BlendCase& size :
       {BlendCase{93, 61, 3, 4, 8, SampleType::kUint8}, BlendCase{37, 21, 3, 6, 8, SampleType::kUint8},
        BlendCase{35, 19, 4, 5, 4, SampleType::kUint8}}) {
    const Scene scene(size, plainDevice());
    expectAgreement(scene, KernelVariant::kCpu);
    EXPECT_EQ(scene.blendRows(0, size.height, 0.0f, KernelVariant::kCpu), scene.neutral);
  }
}

TEST_P(Blend, ZeroWeightsGiveTheNeutralBitForBit) {
  const auto& [size, variant] = GetParam();
  const Scene scene(size);
  EXPECT_EQ(scene.blendRows(0, size.height, 0.0f, variant), scene.neutral);
}

TEST_P(Blend, ValuesAreTheReferenceNeitherRoundedNorClamped) {
  const auto& [size, variant] = GetParam();
  const Scene scene(size);
  const std::vector<double> weights(scene.weights.begin(), scene.weights.end());
  const std::vector<double> expected = reference::blendFrame(scene.textures, weights, scene.columns, scene.rows);
  const std::vector<float> values = scene.blendValues(0, size.height, 1.0f, variant);
  const double unit = 255.0 / scene.textures.full_scale;
  ASSERT_EQ(values.size(), expected.size());
  double lowest = 0.0, highest = 0.0;
  for (std::size_t s = 0; s < expected.size(); ++s) {
    const double value = static_cast<double>(values[s]);
    ASSERT_NEAR(value, expected[s] * unit, 3e-6 * 255.0) << s;
    lowest = std::min(lowest, value);
    highest = std::max(highest, value);
  }
  if (size.width * size.height < 100) return;
  EXPECT_LT(lowest, -1.0);
  EXPECT_GT(highest, size.type == SampleType::kFloat32 ? 254.0 : 256.0);
}

TEST_P(Blend, ValuesOfZeroWeightsAreTheNeutral) {
  const auto& [size, variant] = GetParam();
  const Scene scene(size);
  const std::vector<float> values = scene.blendValues(0, size.height, 0.0f, variant);
  for (std::size_t s = 0; s < values.size(); ++s) {
    const double expected = scene.textures.neutral[s] * 255.0 / scene.textures.full_scale;
    if (size.type == SampleType::kUint8) {
      ASSERT_EQ(static_cast<double>(values[s]), expected) << s;
    } else {
      ASSERT_NEAR(static_cast<double>(values[s]), expected, 3e-7 * 255.0) << s;
    }
  }
}

TEST_P(Blend, BandsHaveTheBitsOfTheWhole) {
  const auto& [size, variant] = GetParam();
  const Scene scene(size);
  const std::vector<std::byte> whole = scene.blendRows(0, size.height, 1.0f, variant);
  std::vector<std::byte> bands;
  for (int begin = 0; begin < size.height; begin += 24) {
    const std::vector<std::byte> band = scene.blendRows(begin, std::min(begin + 24, size.height), 1.0f, variant);
    bands.insert(bands.end(), band.begin(), band.end());
  }
  EXPECT_EQ(bands, whole);
  if (size.height <= 24) return;
  std::vector<float> values = scene.blendValues(0, size.height, 1.0f, variant);
  values.erase(values.begin(), values.begin() + std::ptrdiff_t{24} * size.width * size.channels);
  EXPECT_EQ(scene.blendValues(24, size.height, 1.0f, variant), values);
}

INSTANTIATE_TEST_SUITE_P(
    Sizes, Blend,
    testing::Combine(
        testing::Values(
            BlendCase{93, 61, 3, 4, 8, SampleType::kUint8}, BlendCase{93, 61, 4, 4, 4, SampleType::kUint8},
            BlendCase{93, 61, 1, 4, 16, SampleType::kUint8}, BlendCase{64, 48, 3, 4, 8, SampleType::kUint8},
            BlendCase{64, 48, 4, 8, 8, SampleType::kUint8}, BlendCase{1, 1, 3, 4, 8, SampleType::kUint8},
            BlendCase{35, 19, 4, 4, 8, SampleType::kUint8}, BlendCase{35, 19, 3, 4, 8, SampleType::kFloat32},
            BlendCase{17, 9, 2, 1, 1, SampleType::kUint8}, BlendCase{64, 16, 2, 3, 2, SampleType::kUint8},
            BlendCase{33, 40, 3, 5, 5, SampleType::kUint8}, BlendCase{50, 50, 3, 4, 100, SampleType::kUint8},
            BlendCase{93, 61, 3, 4, 8, SampleType::kUint16}, BlendCase{32, 32, 2, 4, 8, SampleType::kUint16},
            BlendCase{93, 61, 1, 1, 3, SampleType::kUint16}, BlendCase{32, 16, 4, 4, 24, SampleType::kUint16},
            BlendCase{93, 61, 3, 4, 8, SampleType::kFloat32}, BlendCase{32, 24, 1, 1, 8, SampleType::kFloat32},
            BlendCase{93, 61, 4, 2, 6, SampleType::kFloat32}, BlendCase{512, 300, 3, 4, 8, SampleType::kUint8},
            BlendCase{37, 21, 3, 6, 8, SampleType::kUint8}, BlendCase{37, 21, 1, 7, 4, SampleType::kUint16},
            BlendCase{37, 21, 3, 4, 8, SampleType::kUint8, 16}, BlendCase{37, 21, 1, 1, 4, SampleType::kUint8, 16},
            BlendCase{37, 21, 4, 5, 8, SampleType::kUint16, 16}, BlendCase{37, 21, 1, 3, 5, SampleType::kFloat32, 16},
            BlendCase{17, 9, 2, 3, 1, SampleType::kUint8, 16}, BlendCase{93, 61, 3, 8, 8, SampleType::kUint16, 16}),
        testing::Values(KernelVariant::kCpu, KernelVariant::kGpu)));

TEST(Blend, VariantsAgreeToTheRounding) {
  const Scene scene({64, 48, 3, 4, 8, SampleType::kFloat32});
  const std::vector<std::byte> cpu = scene.blendRows(0, 48, 1.0f, KernelVariant::kCpu);
  const std::vector<std::byte> gpu = scene.blendRows(0, 48, 1.0f, KernelVariant::kGpu);
  for (std::size_t s = 0; s < 64 * 48 * 3; ++s) ASSERT_NEAR(scene.sampleAt(cpu, s), scene.sampleAt(gpu, s), 3e-6);
}

TEST(CellRowsOf, CoversWhatTheRowsInterpolateBetween) {
  for (const int s : {1, 2, 3, 7, 8, 16, 100}) {
    const int height = 173, cells = (height - 1) / s + 1;
    for (int begin = 0; begin < height; begin += 8) {
      const int end = std::min(begin + 8, height);
      const auto [first, last] = blend::cellRowsOf(begin, end, s, cells);
      const double top = std::clamp((begin + 0.5) / s - 0.5, 0.0, cells - 1.0);
      const double bottom = std::clamp((end - 0.5) / s - 0.5, 0.0, cells - 1.0);
      EXPECT_LE(first, static_cast<int>(std::floor(top)));
      EXPECT_GT(last, static_cast<int>(std::ceil(bottom)));
      EXPECT_GE(first, 0);
      EXPECT_LE(last, cells);
    }
  }
}

}  // namespace
}  // namespace facezip
