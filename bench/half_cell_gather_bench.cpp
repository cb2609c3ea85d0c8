#include "grid_rows.hpp"
#include "problems/half_cell_gather.hpp"

namespace facezip::bench {
namespace {

void halfCellGather(benchmark::State& state) { benchStep(state, gridProblem<test::HalfCellGatherProblem>(state)); }
BENCHMARK(halfCellGather)->Name("half_cell_gather")->Apply(gridArguments);

}  // namespace
}  // namespace facezip::bench
