#include "difference_texture_rows.hpp"

namespace facezip::bench {
namespace {

void differenceTexture(benchmark::State& state) { benchDifferenceTexture<test::DifferenceTextureProblem>(state); }
BENCHMARK(differenceTexture)->Name("difference_texture")->Apply(differenceTextureArguments);

}  // namespace
}  // namespace facezip::bench
