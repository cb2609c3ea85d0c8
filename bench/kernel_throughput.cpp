// kernel_throughput - every kernel beside what the device can do at most, measured in the same run.
//   kernel_throughput [--device SELECTOR] [Google Benchmark's options, for example --benchmark_filter=gram]
// "best_ms" is the best iteration and the other counters are made of it; "of_copy" and "of_fma" are fractions of the
// roofs that the header prints. Numbers of a shared CPU vary by a quarter between runs; the fractions vary less.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <cstdio>
#include <string>
#include <string_view>

#include "roof.hpp"

namespace facezip::bench {
namespace {

std::string g_selector = "auto";

/// Takes --device SELECTOR out of the arguments; Google Benchmark refuses what it does not know.
void takeDevice(int& argc, char** argv) {
  int kept = 1;
  for (int i = 1; i < argc; ++i) {
    if (std::string_view(argv[i]) == "--device" && i + 1 < argc) {
      g_selector = argv[++i];
    } else {
      argv[kept++] = argv[i];
    }
  }
  argc = kept;
}

}  // namespace

device::DeviceContext& benchDevice() {
  static Device device = openDevice(g_selector);
  return device.context();
}

int run(int argc, char** argv) {
  takeDevice(argc, argv);
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  const DeviceInfo& info = benchDevice().info();
  benchmark::AddCustomContext("device", fmt::format("{} ({})", info.name, info.platform));
  benchmark::AddCustomContext("driver", fmt::format("{}, {}", info.driver, info.version));
  benchmark::AddCustomContext("compiler", __VERSION__);
  benchmark::AddCustomContext("copy roof", fmt::format("{:.1f} GB/s", roof().copy_gb_per_s));
  benchmark::AddCustomContext("FMA roof", fmt::format("{:.1f} GFLOP/s", roof().fma_gflop_per_s));
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}

}  // namespace facezip::bench

int main(int argc, char** argv) {
  try {
    return facezip::bench::run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "kernel_throughput: %s\n", error.what());
    return 1;
  }
}
