#include "grid_rows.hpp"
#include "problems/difference_target.hpp"

namespace facezip::bench {
namespace {

using device::KernelVariant;
using test::DifferenceTargetProblem;

void differenceTarget(benchmark::State& state, KernelVariant variant) {
  benchStep(state, gridProblem<DifferenceTargetProblem>(state, variant));
}
BENCHMARK_CAPTURE(differenceTarget, cpu, KernelVariant::kCpu)->Name("difference_target")->Apply(gridArguments);
BENCHMARK_CAPTURE(differenceTarget, gpu, KernelVariant::kGpu)->Name("difference_target_gpu")->Apply(smallGridArguments);

}  // namespace
}  // namespace facezip::bench
