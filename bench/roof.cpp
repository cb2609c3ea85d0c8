#include "roof.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

namespace facezip::bench {
namespace {

// Benchmarks only, so not among the kernels of the library. Twelve sums hide the latency of two FMA pipes; the start
// values keep them finite.
constexpr const char* kRoofSource = R"(
kernel void roof_copy(global const float16* from, global float16* to) {
  const size_t first = get_global_id(0) * 64;
  for (size_t i = first; i < first + 64; ++i) to[i] = from[i];
}
#define FOR_SUMS(step) step(0) step(1) step(2) step(3) step(4) step(5) step(6) step(7) step(8) step(9) step(10) step(11)
kernel void roof_fma(global float16* out, float scale, int rounds) {
#define START(i) float16 s##i = (float16)(i + get_global_id(0) * 0.001f);
  FOR_SUMS(START)
  for (int r = 0; r < rounds; ++r) {
#define STEP(i) s##i = fma(s##i, (float16)(scale), (float16)(scale));
    FOR_SUMS(STEP)
  }
  float16 sum = (float16)(0.0f);
#define ADD(i) sum += s##i;
  FOR_SUMS(ADD)
  out[get_global_id(0)] = sum;
}
)";
constexpr std::size_t kCopyBytes = std::size_t{128} << 20;
constexpr int kTries = 8;

double secondsOf(const std::function<void()>& step) {
  const auto start = std::chrono::steady_clock::now();
  step();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double bestOf(int tries, const std::function<void()>& step) {
  double best = std::numeric_limits<double>::infinity();
  for (int i = 0; i < tries; ++i) best = std::min(best, secondsOf(step));
  return best;
}

double copyRoof(const device::DeviceContext& context, const cl::Program& program) {
  const std::size_t bytes = std::min<std::size_t>(kCopyBytes, context.info().largest_allocation_bytes / 2);
  const std::size_t items = bytes / (64 * 64);
  const cl::Buffer from = context.allocate(bytes, CL_MEM_READ_WRITE, "roof");
  const cl::Buffer to = context.allocate(bytes, CL_MEM_READ_WRITE, "roof");
  context.queue().enqueueFillBuffer(from, 1.0f, 0, bytes);
  const cl::Kernel kernel(program, "roof_copy");
  const double seconds = bestOf(kTries, [&] {
    context.launch(kernel, device::WorkItems(items), from, to);
    context.finish();
  });
  return 2.0 * static_cast<double>(items * 64 * 64) / seconds * 1e-9;
}

double fmaRoof(const device::DeviceContext& context, const cl::Program& program) {
  // A CPU is filled by a few items per unit, a GPU by thousands.
  const bool gpu = context.info().type == DeviceInfo::Type::kGpu;
  const std::size_t items = std::size_t{context.info().compute_units} * (gpu ? 1024 : 16);
  const int rounds = gpu ? 2000 : 20000;
  const cl::Buffer out = context.allocate(items * 64, CL_MEM_READ_WRITE, "roof");
  const cl::Kernel kernel(program, "roof_fma");
  const double seconds = bestOf(kTries, [&] {
    context.launch(kernel, device::WorkItems(items), out, 0.5f, rounds);
    context.finish();
  });
  return static_cast<double>(items) * rounds * 12.0 * 16.0 * 2.0 / seconds * 1e-9;
}

/// Seconds of the best iteration when measure() ran the loop; else 0.
double bestSeconds(const benchmark::State& state) {
  const auto found = state.counters.find("best_ms");
  return found == state.counters.end() ? 0.0 : found->second.value * 1e-3;
}

void setRate(benchmark::State& state, const char* name, double amount) {
  const double best = bestSeconds(state);
  state.counters[name] = best > 0.0 ? benchmark::Counter(amount / best)
                                    : benchmark::Counter(amount, benchmark::Counter::kIsIterationInvariantRate);
}

}  // namespace

const Roof& roof() {
  static const Roof measured = [] {
    device::DeviceContext& context = benchDevice();
    cl::Program program(context.context(), kRoofSource);
    program.build({context.device()}, "-cl-std=CL1.2");
    return Roof{copyRoof(context, program), fmaRoof(context, program)};
  }();
  return measured;
}

void measure(benchmark::State& state, const std::function<void()>& step) {
  step();  // builds the kernels and touches the buffers
  double best = std::numeric_limits<double>::infinity();
  for (auto _ : state) {
    const double seconds = secondsOf(step);
    state.SetIterationTime(seconds);
    best = std::min(best, seconds);
  }
  state.counters["best_ms"] = best * 1e3;
}

void measureBesideMemcpy(benchmark::State& state, double bytes, const std::function<void()>& step) {
  const auto half = static_cast<std::size_t>(bytes / 2.0);
  const std::vector<char> from(half, 1);
  std::vector<char> to(half);
  const auto copy = [&] {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, half, std::size_t{1} << 18), [&](const auto& range) {
      std::memcpy(to.data() + range.begin(), from.data() + range.begin(), range.size());
    });
  };
  copy();
  std::vector<double> ratios;
  step();  // builds the kernels and touches the buffers
  double best = std::numeric_limits<double>::infinity();
  for (auto _ : state) {
    const double copying = secondsOf(copy);
    const double seconds = secondsOf(step);
    state.SetIterationTime(seconds);
    best = std::min(best, seconds);
    ratios.push_back(copying / seconds);
  }
  state.counters["best_ms"] = best * 1e3;
  state.counters["of_memcpy"] = median(ratios);
}

void setBandwidthCounters(benchmark::State& state, double bytes_per_iteration) {
  setRate(state, "GB/s", bytes_per_iteration * 1e-9);
  setRate(state, "of_copy", bytes_per_iteration * 1e-9 / roof().copy_gb_per_s);
}

void setFlopCounters(benchmark::State& state, double flops_per_iteration) {
  setRate(state, "GFLOP/s", flops_per_iteration * 1e-9);
  setRate(state, "of_fma", flops_per_iteration * 1e-9 / roof().fma_gflop_per_s);
}

}  // namespace facezip::bench
