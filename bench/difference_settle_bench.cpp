#include "grid_rows.hpp"
#include "problems/difference_settle.hpp"

namespace facezip::bench {
namespace {

using device::KernelVariant;
using test::DifferenceSettleProblem;

void differenceSettle(benchmark::State& state, KernelVariant variant) {
  benchStep(state, gridProblem<DifferenceSettleProblem>(state, variant));
}
BENCHMARK_CAPTURE(differenceSettle, cpu, KernelVariant::kCpu)->Name("difference_settle")->Apply(gridArguments);
BENCHMARK_CAPTURE(differenceSettle, gpu, KernelVariant::kGpu)->Name("difference_settle_gpu")->Apply(smallGridArguments);

}  // namespace
}  // namespace facezip::bench
