#include "grid_rows.hpp"
#include "problems/weight_system_gather.hpp"

namespace facezip::bench {
namespace {

void weightSystemGather(benchmark::State& state) {
  benchStep(state, gridProblem<test::WeightSystemGatherProblem>(state));
}
BENCHMARK(weightSystemGather)->Name("weight_system_gather")->Apply(gridArguments);

}  // namespace
}  // namespace facezip::bench
