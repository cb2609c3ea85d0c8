// roof.hpp - what the device can do at most, measured in the same run as the kernels, and counters that compare with
// it. A time alone says little on a shared machine; a fraction of the roof of the same minute does.
#pragma once

#include <benchmark/benchmark.h>

#include <functional>

#include "device/device_context.hpp"

namespace facezip::bench {

/// Ceilings of one device.
struct Roof {
  double copy_gb_per_s = 0.0;    ///< read + write of a copy kernel over buffers beyond any cache
  double fma_gflop_per_s = 0.0;  ///< independent float16 multiply-adds in registers
};

/// The device of --device SELECTOR, opened once.
device::DeviceContext& benchDevice();

/// The roof of benchDevice(), measured when first asked for.
const Roof& roof();

/// Runs the loop of a benchmark: `step` must wait for the device. Records the best iteration for the counters below,
/// since other work on the machine only ever adds time. Register the benchmark with UseManualTime().
void measure(benchmark::State& state, const std::function<void()>& step);

/// The same, each iteration beside a copy of the bytes that it must read and write: half of them read, half written, by
/// memcpy in as many threads as the machine has. Counter "of_memcpy" is the median over iterations of the copy's time
/// over the step's, which other work on the machine moves least.
void measureBesideMemcpy(benchmark::State& state, double bytes, const std::function<void()>& step);

/// To be called after the loop. Counters "GB/s" and "of_copy" (fraction of the roof) from the bytes that one iteration
/// must read and write.
void setBandwidthCounters(benchmark::State& state, double bytes_per_iteration);

/// Counters "GFLOP/s" and "of_fma" from the useful operations of one iteration; a multiply-add counts as two.
void setFlopCounters(benchmark::State& state, double flops_per_iteration);

/// A row of a step: runs its problem (tests/problems) and counts what that says must be moved and computed.
template <typename Problem>
void benchStep(benchmark::State& state, Problem&& problem) {
  measure(state, [&] { problem.run(); });
  if constexpr (requires { problem.bytes(); }) setBandwidthCounters(state, problem.bytes());
  if constexpr (requires { problem.flops(); }) setFlopCounters(state, problem.flops());
}

/// How every row is registered.
inline void milliseconds(benchmark::internal::Benchmark* row) { row->UseManualTime()->Unit(benchmark::kMillisecond); }

}  // namespace facezip::bench
