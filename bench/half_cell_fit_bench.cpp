#include "grid_rows.hpp"
#include "problems/half_cell_fit.hpp"

namespace facezip::bench {
namespace {

void halfCellFit(benchmark::State& state) { benchStep(state, gridProblem<test::HalfCellFitProblem>(state)); }
BENCHMARK(halfCellFit)->Name("half_cell_fit")->Apply(gridArguments);

}  // namespace
}  // namespace facezip::bench
