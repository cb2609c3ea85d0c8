#include "grid_rows.hpp"
#include "problems/weight_system.hpp"

namespace facezip::bench {
namespace {

using device::KernelVariant;

void weightSystem(benchmark::State& state, KernelVariant variant) {
  benchStep(state, gridProblem<test::WeightSystemProblem>(state, variant));
}
BENCHMARK_CAPTURE(weightSystem, cpu, KernelVariant::kCpu)->Name("weight_system")->Apply(gridArguments);
BENCHMARK_CAPTURE(weightSystem, gpu, KernelVariant::kGpu)->Name("weight_system_gpu")->Apply(smallGridArguments);

}  // namespace
}  // namespace facezip::bench
