// blend_bench.cpp - the run time: blended weight maps and frames (Eq. 8), against copying the same bytes.
#include <benchmark/benchmark.h>

#include <cstdint>
#include <string>
#include <vector>

#include "blend/blend.hpp"
#include "blend/weight_blend.hpp"
#include "roof.hpp"

namespace facezip::bench {
namespace {

std::vector<std::byte> hashedBytes(std::size_t count) {
  std::vector<std::byte> bytes(count);
  std::uint64_t state = 1;
  for (std::byte& b : bytes) {
    state = state * 6364136223846793005u + 1442695040888963407u;
    b = static_cast<std::byte>(state >> 56);
  }
  return bytes;
}

using device::KernelVariant;

blend::WeightMaps makeWeights(int cells, int expressions, KernelVariant variant = KernelVariant::kAuto) {
  const blend::WeightGrid grid{cells, cells, expressions, std::vector<double>(4, 1.0 / 255.0),
                               std::vector<double>(4, 0.0)};
  return blend::WeightMaps(benchDevice(), grid, hashedBytes(grid.codeBytes()), variant);
}

std::vector<float> everyWeight(int expressions) {
  std::vector<float> beta;
  for (int n = 0; n < expressions; ++n) beta.push_back(0.01f * static_cast<float>(n + 1));
  return beta;
}

/// Textures of a whole square map, and the blended weights they are sampled with.
struct Scene {
  Scene(int side, int channels, image::SampleType type, int difference_bits, int expressions = 52,
        KernelVariant variant = KernelVariant::kAuto)
      : shape{side,
              channels,
              4,
              difference_bits,
              type,
              8,
              std::vector<float>(static_cast<std::size_t>(4 * channels), 1.0f),
              std::vector<float>(static_cast<std::size_t>(4 * channels), 128.0f)},
        weights(makeWeights(side / 8, expressions)),
        textures(benchDevice(), shape, side, side / 8, side / 8, variant) {
    const std::size_t rows = static_cast<std::size_t>(side);
    std::vector<std::byte> neutral = hashedBytes(rows * shape.rowBytes());
    if (type == image::SampleType::kFloat32) std::fill(neutral.begin(), neutral.end(), std::byte{0});
    const std::vector<std::byte> codes = hashedBytes(rows * shape.differenceRowBytes());
    textures.setRows(0, side);
    textures.load(0, side, neutral, std::vector<std::span<const std::byte>>(4, codes));
    weights.blend(everyWeight(expressions));
    benchDevice().finish();
  }

  /// Bytes that a frame must move: neutral, four differences, the frame.
  double bytes() const {
    const double rows = shape.width;
    return rows * (2.0 * static_cast<double>(shape.rowBytes()) + 4.0 * static_cast<double>(shape.differenceRowBytes()));
  }

  blend::TextureShape shape;
  blend::WeightMaps weights;
  blend::TextureRows textures;
};

void blendKernel(benchmark::State& state, int channels, image::SampleType type, int difference_bits = 8,
                 KernelVariant variant = KernelVariant::kAuto) {
  Scene scene(static_cast<int>(state.range(0)), channels, type, difference_bits, 52, variant);
  const cl::Buffer frame = benchDevice().allocate(scene.textures.frameBytes(), CL_MEM_WRITE_ONLY, "frame");
  measure(state, [&] {
    scene.textures.enqueue(scene.weights.weights(), frame);
    benchDevice().finish();
  });
  setBandwidthCounters(state, scene.bytes());
}

/// The same, with float32 values before rounding in place of samples.
void blendValuesKernel(benchmark::State& state, int channels, image::SampleType type) {
  Scene scene(static_cast<int>(state.range(0)), channels, type, /* difference_bits= */ 8);
  constexpr auto kForm = blend::FrameForm::kValues;
  const cl::Buffer frame = benchDevice().allocate(scene.textures.frameBytes(kForm), CL_MEM_WRITE_ONLY, "values");
  measure(state, [&] {
    scene.textures.enqueue(scene.weights.weights(), frame, kForm);
    benchDevice().finish();
  });
  const double widened = static_cast<double>(scene.textures.frameBytes(kForm) - scene.textures.frameBytes());
  setBandwidthCounters(state, scene.bytes() + widened);
}

/// A frame as a caller gets it: new weights of 52 expressions, the kernel, rows in the caller's memory.
void wholeFrame(benchmark::State& state, int channels, image::SampleType type) {
  Scene scene(static_cast<int>(state.range(0)), channels, type, /* difference_bits= */ 8);
  const std::vector<float> beta = everyWeight(52);
  std::vector<std::byte> out(static_cast<std::size_t>(scene.shape.width) * scene.shape.rowBytes());
  measure(state, [&] {
    scene.weights.blend(beta);
    scene.textures.blend(scene.weights.weights(), out);
  });
  setBandwidthCounters(state, scene.bytes());
}

/// What of a frame is timed beside a memcpy of the bytes that it must move.
enum class Part { kKernel, kWeightsAndKernel, kWholeFrame };

/// Arguments: side, N. kWholeFrame is what a caller gets: new weights, the kernel, rows in the caller's memory.
void frameBesideMemcpy(benchmark::State& state, Part part) {
  Scene scene(static_cast<int>(state.range(0)), 3, image::SampleType::kUint8, 8, static_cast<int>(state.range(1)));
  const std::vector<float> beta = everyWeight(static_cast<int>(state.range(1)));
  const cl::Buffer frame = benchDevice().allocate(scene.textures.frameBytes(), CL_MEM_WRITE_ONLY, "frame");
  std::vector<std::byte> out(static_cast<std::size_t>(scene.shape.width) * scene.shape.rowBytes());
  measureBesideMemcpy(state, scene.bytes(), [&] {
    if (part != Part::kKernel) scene.weights.blend(beta);
    if (part == Part::kWholeFrame) return scene.textures.blend(scene.weights.weights(), out);
    scene.textures.enqueue(scene.weights.weights(), frame);
    benchDevice().finish();
  });
  setBandwidthCounters(state, scene.bytes());
}

void weightBlend(benchmark::State& state, KernelVariant variant) {
  const int cells = static_cast<int>(state.range(0)), expressions = static_cast<int>(state.range(1));
  blend::WeightMaps weights = makeWeights(cells, expressions, variant);
  const std::vector<float> beta = everyWeight(expressions);
  measure(state, [&] {
    weights.blend(beta);
    benchDevice().finish();
  });
  const double outputs = 4.0 * cells * cells;
  setBandwidthCounters(state, outputs * (expressions + static_cast<double>(sizeof(float))));
}

void milliseconds(benchmark::internal::Benchmark* row) { row->UseManualTime()->Unit(benchmark::kMillisecond); }
void besideMemcpy(benchmark::internal::Benchmark* row) { row->ArgNames({"side", "N"})->Args({2048, 52}); }

constexpr auto kUint8 = image::SampleType::kUint8;
BENCHMARK_CAPTURE(blendKernel, rgb8, 3, kUint8)->RangeMultiplier(2)->Range(256, 4096)->Apply(milliseconds);
BENCHMARK_CAPTURE(blendKernel, rgb8_gpu, 3, kUint8, 8, KernelVariant::kGpu)->Arg(512)->Apply(milliseconds);
BENCHMARK_CAPTURE(blendKernel, rgba8, 4, kUint8)->Arg(2048)->Apply(milliseconds);
BENCHMARK_CAPTURE(blendKernel, grey8, 1, kUint8)->Arg(2048)->Apply(milliseconds);
BENCHMARK_CAPTURE(blendKernel, rgb16, 3, image::SampleType::kUint16)->Arg(2048)->Apply(milliseconds);
BENCHMARK_CAPTURE(blendKernel, rgb_float, 3, image::SampleType::kFloat32)->Arg(2048)->Apply(milliseconds);
BENCHMARK_CAPTURE(blendKernel, rgb8_differences16, 3, kUint8, 16)->Arg(2048)->Apply(milliseconds);
BENCHMARK_CAPTURE(blendValuesKernel, rgb8, 3, kUint8)->Arg(2048)->Apply(milliseconds);
BENCHMARK_CAPTURE(wholeFrame, rgb8, 3, kUint8)->Arg(1024)->Arg(2048)->Apply(milliseconds);
BENCHMARK_CAPTURE(frameBesideMemcpy, kernel, Part::kKernel)->Apply(besideMemcpy)->Apply(milliseconds);
BENCHMARK_CAPTURE(frameBesideMemcpy, weights_and_kernel, Part::kWeightsAndKernel)
    ->Apply(besideMemcpy)
    ->Apply(milliseconds);
BENCHMARK_CAPTURE(frameBesideMemcpy, whole_frame, Part::kWholeFrame)->Apply(besideMemcpy)->Apply(milliseconds);

void grids(benchmark::internal::Benchmark* row) { row->ArgNames({"cells", "N"})->Apply(milliseconds); }
BENCHMARK_CAPTURE(weightBlend, cpu, KernelVariant::kCpu)
    ->Apply(grids)
    ->Args({32, 20})
    ->Args({128, 8})
    ->Args({128, 20})
    ->Args({256, 52})
    ->Args({256, 100})
    ->Args({512, 20});
BENCHMARK_CAPTURE(weightBlend, gpu, KernelVariant::kGpu)->Apply(grids)->Args({128, 20});

}  // namespace
}  // namespace facezip::bench
