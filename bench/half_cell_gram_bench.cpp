#include "grid_rows.hpp"
#include "problems/half_cell_gram.hpp"

namespace facezip::bench {
namespace {

void halfCellGram(benchmark::State& state) { benchStep(state, gridProblem<test::HalfCellGramProblem>(state)); }
BENCHMARK(halfCellGram)->Name("half_cell_gram")->Apply(gridArguments);

}  // namespace
}  // namespace facezip::bench
