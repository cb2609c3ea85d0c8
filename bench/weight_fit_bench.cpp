// weight_fit_bench.cpp - both halves of a turn of the refinement: difference textures under given weights, and grid
// weights under given difference textures. Three channels of 8 bits; a turn takes three sweeps of weight_relax.
#include <benchmark/benchmark.h>

#include <vector>

#include "compress/bands/difference.hpp"
#include "compress/refine/difference_fit.hpp"
#include "compress/refine/half_cells.hpp"
#include "compress/refine/weight_system.hpp"
#include "compress/refine/weight_window.hpp"
#include "compress/search/counter_hash.hpp"
#include "roof.hpp"
#include "synthetic_capture.hpp"

namespace facezip::bench {
namespace {

using device::KernelVariant;

constexpr int kWeightScale = 8;
constexpr int kSweeps = 3;
constexpr float kRidge = 1e-3f;

/// Arguments: R, N, C. A window that holds the whole of a square map, every weight free and hashed from its place.
struct FitBench {
  explicit FitBench(const benchmark::State& state, KernelVariant variant = KernelVariant::kAuto)
      : shape{static_cast<int>(state.range(0)), static_cast<int>(state.range(0)), 3, static_cast<int>(state.range(1)),
              image::SampleType::kUint8},
        space{shape.width / kWeightScale, shape.rows / kWeightScale, static_cast<int>(state.range(2)),
              shape.expressions},
        tiles(context),
        window(context, space),
        fit(context, space, variant),
        system(context, space, variant) {
    const compress::TileMasks masks = makeBumpMasks(shape.width, 1);
    tiles.upload(masks);
    tile_at = context.upload(compress::tileLookup(masks, shape), "lookup of tiles");
    const cl::Buffer samples = context.upload(makeSamples(shape), "samples");
    differences = context.allocate(static_cast<std::size_t>(differenceBytes()), CL_MEM_READ_WRITE, "differences");
    compress::computeDifferences(context, tiles, shape, samples, differences);
    const std::vector<float> weights = hashedWeights();
    window.set({0, space.rows, 0, space.rows}, weights, weights);
    fit.compute(band(), window, kRidge);
    context.finish();
  }

  /// 0 to 1; lanes past N are 0.
  std::vector<float> hashedWeights() const {
    std::vector<float> weights(static_cast<std::size_t>(space.rows) * space.rowFloats(), 0.0f);
    for (std::size_t i = 0; i < weights.size(); ++i) {
      if (i % space.lanes() >= static_cast<std::size_t>(space.expressions)) continue;
      weights[i] = static_cast<float>(compress::counterHash(1, i, 0, 0) >> 40) * 0x1.0p-24f;
    }
    return weights;
  }

  compress::GridBand band() const { return {tiles, shape, differences, 0, kWeightScale}; }

  double texels() const { return static_cast<double>(tiles.tileCount()) * compress::kTileTexels; }
  double cells() const { return static_cast<double>(space.columns) * space.rows; }
  double pairs() const { return space.textures * (space.textures + 1) / 2.0; }
  double differenceBytes() const {
    return static_cast<double>(compress::differenceBufferBytes(shape, tiles.tileCount()));
  }
  double textureBytes() const { return texels() * space.textures * shape.channels * sizeof(float); }
  double texelWeightBytes() const { return texels() * sizeof(float); }
  double weightBytes() const { return cells() * static_cast<double>(space.cellFloats() * sizeof(float)); }
  double systemBytes() const { return cells() * static_cast<double>(space.systemEntries() * sizeof(float)); }
  double partialBytes() const {
    return static_cast<double>(tiles.tileCount() * compress::systemBytesOfTile(space, kWeightScale));
  }

  device::DeviceContext& context = benchDevice();
  compress::BandShape shape;
  compress::WeightSpace space;
  compress::DeviceTiles tiles;
  compress::WeightWindow window;
  compress::DifferenceFit fit;
  compress::WeightSystem system;
  cl::Buffer tile_at;
  cl::Buffer differences;
};

/// Must move: differences, texel weights and the mask that marks what is wanted, grid weights in; textures out.
/// Operations: a weight between two rows of cells, the sums of the C x C system, its right-hand sides and the energy,
/// for each expression; the solution, about a tenth more at N = 20, is left out.
void setFitCounters(benchmark::State& state, const FitBench& bench) {
  setBandwidthCounters(
      state, bench.differenceBytes() + 2.0 * bench.texelWeightBytes() + bench.weightBytes() + bench.textureBytes());
  const double textures = bench.space.textures;
  const double channels = bench.shape.channels;
  setFlopCounters(state, 2.0 * bench.texels() * bench.space.expressions *
                             (textures + bench.pairs() + textures * channels + channels));
}

void differenceFit(benchmark::State& state, KernelVariant variant) {
  FitBench bench(state, variant);
  measure(state, [&] {
    bench.fit.compute(bench.band(), bench.window, kRidge);
    bench.context.finish();
  });
  setFitCounters(state, bench);
}

void differenceFitRounded(benchmark::State& state) {
  FitBench bench(state);
  const std::vector<compress::TextureEncoding> encoding(
      static_cast<std::size_t>(bench.space.textures * bench.shape.channels), {1.0f, -128.0f});
  measure(state, [&] {
    bench.fit.computeRounded(bench.band(), bench.window, kRidge, encoding, /* bits= */ 8);
    bench.context.finish();
  });
  setFitCounters(state, bench);
}

/// Must move: differences, texel weights and textures in, the sums of the tiles out. Operations: for each pair of
/// textures a product over channels and its share in three pairs of rows; for each expression the weighted difference,
/// a product with each texture and its share in two rows.
void weightSystem(benchmark::State& state, KernelVariant variant) {
  FitBench bench(state, variant);
  measure(state, [&] {
    bench.system.sumTiles(bench.band(), bench.fit.textures());
    bench.context.finish();
  });
  setBandwidthCounters(
      state, bench.differenceBytes() + bench.texelWeightBytes() + bench.textureBytes() + bench.partialBytes());
  const double channels = bench.shape.channels;
  const double blocks = bench.pairs() * (2.0 * channels + 6.0);
  const double sides = bench.space.expressions * (channels + bench.space.textures * (2.0 * channels + 4.0));
  setFlopCounters(state, bench.texels() * (blocks + sides));
}

/// Must move: the sums of the tiles once in, the equations once out.
void weightSystemGather(benchmark::State& state) {
  FitBench bench(state);
  bench.system.sumTiles(bench.band(), bench.fit.textures());
  measure(state, [&] {
    bench.system.clear();
    bench.system.gather(bench.band(), bench.tile_at, bench.window, 1.0);
    bench.context.finish();
  });
  setBandwidthCounters(state, bench.partialBytes() + bench.systemBytes());
}

/// Must move, each sweep: the equations, where weights started and the weights in, the weights out. Operations: for
/// each expression of a cell a product with the blocks to eight neighbours and two triangles; smoothness and the factor
/// are left out.
void weightRelax(benchmark::State& state) {
  FitBench bench(state);
  bench.system.add(bench.band(), bench.tile_at, bench.fit.textures(), bench.window, 1.0);
  measure(state, [&] {
    bench.system.relax(bench.window, kSweeps, /* smoothness= */ 1.0f, /* trust= */ 1.0f);
    bench.context.finish();
  });
  setBandwidthCounters(state, kSweeps * (bench.systemBytes() + 3.0 * bench.weightBytes()));
  const double block = bench.space.textures * bench.space.textures;
  setFlopCounters(state, kSweeps * 2.0 * bench.cells() * bench.space.expressions * 9.0 * block);
}

/// Half cells of the window, with their Gram matrices.
struct HalfCellBench : FitBench {
  explicit HalfCellBench(const benchmark::State& state) : FitBench(state), halves(context, space) {
    halves.moveTo(window.rows());
    halves.add(band(), tile_at, 1.0);
    halves.fit(window, kRidge);
    context.finish();
  }
  double halfCells() const { return 4.0 * cells(); }
  double gramNumbers() const { return space.expressions * (space.expressions + 1) / 2.0; }
  double gramBytes() const { return halfCells() * gramNumbers() * sizeof(float); }
  double halfEquationBytes() const {
    return halfCells() * (static_cast<double>(space.cellFloats()) + pairs()) * sizeof(float);
  }
  compress::HalfCells halves;
};

/// Must move: differences and texel weights in, Gram matrices out. Operations: the root of the weight once, then a
/// product for each pair of expressions and channel.
void halfCellGram(benchmark::State& state) {
  HalfCellBench bench(state);
  measure(state, [&] {
    bench.halves.moveTo(bench.window.rows());
    bench.halves.add(bench.band(), bench.tile_at, 1.0);
    bench.context.finish();
  });
  setBandwidthCounters(state, bench.differenceBytes() + bench.texelWeightBytes() + bench.gramBytes());
  setFlopCounters(state, bench.texels() * bench.shape.channels * (bench.space.expressions + 2.0 * bench.gramNumbers()));
}

/// Must move: Gram matrices and weights in, equations out. Operations, for each half cell: the weights' products with
/// each other and with the Gram matrix, that with the weights again, and two triangles for each expression.
void halfCellFit(benchmark::State& state) {
  HalfCellBench bench(state);
  measure(state, [&] {
    bench.halves.fit(bench.window, kRidge);
    bench.context.finish();
  });
  setBandwidthCounters(state, bench.gramBytes() + bench.weightBytes() + bench.halfEquationBytes());
  const double c = bench.space.textures;
  const double n = bench.space.expressions;
  setFlopCounters(state, 2.0 * bench.halfCells() * n * (2.0 * bench.pairs() + c * n + c * c));
}

/// Must move: the equations of the half cells in, those of the cells out.
void halfCellGather(benchmark::State& state) {
  HalfCellBench bench(state);
  measure(state, [&] {
    bench.system.gather(bench.halves, bench.window);
    bench.context.finish();
  });
  setBandwidthCounters(state, bench.halfEquationBytes() + bench.systemBytes());
}

void arguments(benchmark::internal::Benchmark* row) {
  row->ArgNames({"R", "N", "C"})->UseManualTime()->Unit(benchmark::kMillisecond);
  row->Args({256, 20, 4})->Args({1024, 8, 4})->Args({1024, 20, 4})->Args({1024, 52, 4});
  row->Args({512, 100, 4})->Args({2048, 8, 4})->Args({1024, 20, 1})->Args({1024, 20, 8});
}
void small(benchmark::internal::Benchmark* row) {
  row->ArgNames({"R", "N", "C"})->UseManualTime()->Unit(benchmark::kMillisecond)->Args({128, 20, 4});
}
BENCHMARK_CAPTURE(differenceFit, cpu, KernelVariant::kCpu)->Name("difference_fit")->Apply(arguments);
BENCHMARK_CAPTURE(differenceFit, gpu, KernelVariant::kGpu)->Name("difference_fit_gpu")->Apply(small);
BENCHMARK(differenceFitRounded)->Name("difference_fit_rounded")->Apply(arguments);
BENCHMARK_CAPTURE(weightSystem, cpu, KernelVariant::kCpu)->Name("weight_system")->Apply(arguments);
BENCHMARK_CAPTURE(weightSystem, gpu, KernelVariant::kGpu)->Name("weight_system_gpu")->Apply(small);
BENCHMARK(weightSystemGather)->Name("weight_system_gather")->Apply(arguments);
BENCHMARK(halfCellGram)->Name("half_cell_gram")->Apply(arguments);
BENCHMARK(halfCellFit)->Name("half_cell_fit")->Apply(arguments);
BENCHMARK(halfCellGather)->Name("half_cell_gather")->Apply(arguments);
BENCHMARK(weightRelax)->Name("weight_relax")->Apply(arguments);

}  // namespace
}  // namespace facezip::bench
