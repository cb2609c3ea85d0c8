#include "difference_texture_rows.hpp"
#include "problems/difference_texture_encode.hpp"

namespace facezip::bench {
namespace {

void differenceTextureEncode(benchmark::State& state) {
  benchDifferenceTexture<test::DifferenceTextureEncodeProblem>(state, /* code_bits= */ 8);
}
BENCHMARK(differenceTextureEncode)->Name("difference_texture_encode")->Apply(differenceTextureArguments);

}  // namespace
}  // namespace facezip::bench
