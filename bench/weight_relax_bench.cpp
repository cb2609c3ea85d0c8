#include "grid_rows.hpp"
#include "problems/weight_relax.hpp"

namespace facezip::bench {
namespace {

/// Three sweeps, as a turn of the refinement takes.
void weightRelax(benchmark::State& state) {
  auto problem = gridProblem<test::WeightRelaxProblem>(state);
  problem.sweeps = 3;
  benchStep(state, problem);
}
BENCHMARK(weightRelax)->Name("weight_relax")->Apply(gridArguments);

}  // namespace
}  // namespace facezip::bench
