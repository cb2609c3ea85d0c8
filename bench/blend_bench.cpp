// blend_bench.cpp - frames (Eq. 8): the kernel, and all that a caller waits for.
#include "problems/blend.hpp"
#include "problems/weight_blend.hpp"
#include "roof.hpp"

namespace facezip::bench {
namespace {

using blend::FrameForm;
using device::KernelVariant;
using image::SampleType;

/// A square map of four differences with weights at 1/8.
test::BlendSizes squareMap(const benchmark::State& state, int channels, SampleType type, int difference_bits) {
  const auto side = static_cast<int>(state.range(0));
  return {side, side, channels, 4, 8, type, difference_bits};
}

/// The whole map on the device; run() is the kernel alone.
struct FrameProblem : test::BlendProblem {
  FrameProblem(const test::BlendSizes& map, KernelVariant on = KernelVariant::kAuto,
               FrameForm frame_form = FrameForm::kSamples)
      : BlendProblem(benchDevice(), map, on),
        form(frame_form),
        rows(load(0, map.height)),
        blended(uploadWeights()),
        frame(context.allocate(rows.frameBytes(form), CL_MEM_WRITE_ONLY, "frame")) {}

  void run() {
    rows.enqueue(blended, frame, form);
    context.finish();
  }
  double bytes() const {
    // Values take more than samples do.
    return BlendProblem::bytes() + static_cast<double>(rows.frameBytes(form) - rows.frameBytes(FrameForm::kSamples));
  }

  FrameForm form;
  blend::TextureRows rows;
  cl::Buffer blended;
  cl::Buffer frame;
};

/// A frame as a caller gets it: new weights of N expressions, the kernel, rows in the caller's memory.
struct WholeFrameProblem : FrameProblem {
  WholeFrameProblem(const test::BlendSizes& map, int expressions)
      : FrameProblem(map),
        weight_maps(benchDevice(), {grid.columns, grid.rows, sizes.differences, expressions}),
        out(samples() * image::sampleBytes(sizes.type)) {
    for (float& beta : weight_maps.beta) beta += beta == 0.0f ? 0.5f : 0.0f;
  }

  void run() {
    weight_maps.on_device.blend(weight_maps.beta);
    rows.blend(weight_maps.on_device.weights(), out);
  }
  void runOnDevice() {
    weight_maps.on_device.blend(weight_maps.beta);
    rows.enqueue(weight_maps.on_device.weights(), frame, form);
    context.finish();
  }

  test::WeightBlendProblem weight_maps;
  std::vector<std::byte> out;
};

void blendKernel(benchmark::State& state, int channels, SampleType type, int difference_bits = 8,
                 KernelVariant variant = KernelVariant::kAuto) {
  benchStep(state, FrameProblem(squareMap(state, channels, type, difference_bits), variant));
}
void blendValues(benchmark::State& state) {
  benchStep(state, FrameProblem(squareMap(state, 3, SampleType::kUint8, 8), KernelVariant::kAuto, FrameForm::kValues));
}
void wholeFrame(benchmark::State& state) {
  benchStep(state, WholeFrameProblem(squareMap(state, 3, SampleType::kUint8, 8), 52));
}

/// What of a frame is timed beside a memcpy of the bytes that it must move.
enum class Part { kKernel, kWeightsAndKernel, kWholeFrame };

/// Arguments: side, N.
void besideMemcpy(benchmark::State& state, Part part) {
  WholeFrameProblem problem(squareMap(state, 3, SampleType::kUint8, 8), static_cast<int>(state.range(1)));
  measureBesideMemcpy(state, problem.bytes(), [&] {
    if (part == Part::kKernel) return problem.FrameProblem::run();
    if (part == Part::kWeightsAndKernel) return problem.runOnDevice();
    problem.run();
  });
  setBandwidthCounters(state, problem.bytes());
}

constexpr auto kUint8 = SampleType::kUint8;
BENCHMARK_CAPTURE(blendKernel, rgb8, 3, kUint8)
    ->Name("blend/rgb8")
    ->RangeMultiplier(2)
    ->Range(256, 4096)
    ->Apply(milliseconds);
BENCHMARK_CAPTURE(blendKernel, rgb8_gpu, 3, kUint8, 8, KernelVariant::kGpu)
    ->Name("blend/rgb8_gpu")
    ->Arg(512)
    ->Apply(milliseconds);
BENCHMARK_CAPTURE(blendKernel, rgba8, 4, kUint8)->Name("blend/rgba8")->Arg(2048)->Apply(milliseconds);
BENCHMARK_CAPTURE(blendKernel, grey8, 1, kUint8)->Name("blend/grey8")->Arg(2048)->Apply(milliseconds);
BENCHMARK_CAPTURE(blendKernel, rgb16, 3, SampleType::kUint16)->Name("blend/rgb16")->Arg(2048)->Apply(milliseconds);
BENCHMARK_CAPTURE(blendKernel, rgb_float, 3, SampleType::kFloat32)
    ->Name("blend/rgb_float")
    ->Arg(2048)
    ->Apply(milliseconds);
BENCHMARK_CAPTURE(blendKernel, rgb8_differences16, 3, kUint8, 16)
    ->Name("blend/rgb8_differences16")
    ->Arg(2048)
    ->Apply(milliseconds);
BENCHMARK(blendValues)->Name("blend_values")->Arg(2048)->Apply(milliseconds);
BENCHMARK(wholeFrame)->Name("whole_frame")->Arg(1024)->Arg(2048)->Apply(milliseconds);

void frameSizes(benchmark::internal::Benchmark* row) {
  row->ArgNames({"side", "N"})->Args({2048, 52})->Apply(milliseconds);
}
BENCHMARK_CAPTURE(besideMemcpy, kernel, Part::kKernel)->Name("beside_memcpy/kernel")->Apply(frameSizes);
BENCHMARK_CAPTURE(besideMemcpy, weights_and_kernel, Part::kWeightsAndKernel)
    ->Name("beside_memcpy/weights_and_kernel")
    ->Apply(frameSizes);
BENCHMARK_CAPTURE(besideMemcpy, whole_frame, Part::kWholeFrame)->Name("beside_memcpy/whole_frame")->Apply(frameSizes);

}  // namespace
}  // namespace facezip::bench
