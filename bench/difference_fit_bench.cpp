#include "grid_rows.hpp"
#include "problems/difference_fit.hpp"

namespace facezip::bench {
namespace {

using device::KernelVariant;
using test::DifferenceFitProblem;

void differenceFit(benchmark::State& state, KernelVariant variant) {
  benchStep(state, gridProblem<DifferenceFitProblem>(state, variant));
}
BENCHMARK_CAPTURE(differenceFit, cpu, KernelVariant::kCpu)->Name("difference_fit")->Apply(gridArguments);
BENCHMARK_CAPTURE(differenceFit, gpu, KernelVariant::kGpu)->Name("difference_fit_gpu")->Apply(smallGridArguments);

/// The same, rounded to codes of 8 bits.
struct Rounded : DifferenceFitProblem {
  using DifferenceFitProblem::DifferenceFitProblem;
  void run() { runRounded(); }
};
void differenceFitRounded(benchmark::State& state) { benchStep(state, gridProblem<Rounded>(state)); }
BENCHMARK(differenceFitRounded)->Name("difference_fit_rounded")->Apply(gridArguments);

}  // namespace
}  // namespace facezip::bench
