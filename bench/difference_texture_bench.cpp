#include <benchmark/benchmark.h>

#include "compress/bands/difference.hpp"
#include "compress/codes/difference_texture_encode.hpp"
#include "compress/codes/difference_texture_range.hpp"
#include "compress/search/difference_texture.hpp"
#include "roof.hpp"
#include "synthetic_capture.hpp"

namespace facezip::bench {
namespace {

constexpr int kTextures = 4;

/// Arguments: R, N, K. Must move: differences and masks once in, textures once out. Operations: a weight per
/// expression, mask and texture, a product per expression, texture and channel.
struct TextureBench {
  explicit TextureBench(const benchmark::State& state)
      : resolution(static_cast<int>(state.range(0))),
        shape{resolution, resolution, 3, static_cast<int>(state.range(1)), image::SampleType::kUint8},
        mask_count(static_cast<int>(state.range(2))),
        masks(makeBumpMasks(resolution, mask_count)),
        tiles(context),
        textures(context, coefficients()) {
    tiles.upload(masks);
    const cl::Buffer samples = context.upload(makeSamples(shape), "samples");
    const std::size_t bytes = compress::differenceBufferBytes(shape, tiles.tileCount());
    differences = context.allocate(bytes, CL_MEM_READ_WRITE, "differences");
    compress::computeDifferences(context, tiles, shape, samples, differences);
    context.finish();
  }

  compress::TextureCoefficients coefficients() const {
    compress::TextureCoefficients table{mask_count, kTextures, shape.expressions, {}};
    for (int k = 0; k < mask_count; ++k) {
      for (int i = 0; i < kTextures; ++i) {
        for (int n = 0; n < shape.expressions; ++n) table.values.push_back((k + n) % kTextures == i ? 0.2f : 0.0f);
      }
    }
    return table;
  }

  double texels() const { return static_cast<double>(tiles.tileCount()) * compress::kTileTexels; }
  double textureBytes() const { return texels() * kTextures * shape.channels * sizeof(float); }
  double maskBytes() const { return static_cast<double>(masks.mask_weights.size() * sizeof(float)); }

  device::DeviceContext& context = benchDevice();
  int resolution;
  compress::BandShape shape;
  int mask_count;
  compress::TileMasks masks;
  compress::DeviceTiles tiles;
  compress::DifferenceTextures textures;
  cl::Buffer differences;
};

void differenceTexture(benchmark::State& state) {
  TextureBench bench(state);
  measure(state, [&] {
    bench.textures.compute(bench.tiles, bench.differences, bench.shape);
    bench.context.finish();
  });
  const auto in = static_cast<double>(compress::differenceBufferBytes(bench.shape, bench.tiles.tileCount()));
  setBandwidthCounters(state, in + bench.maskBytes() + bench.textureBytes());
  const double weights = static_cast<double>(bench.masks.mask_weights.size());
  setFlopCounters(state, 2.0 * kTextures * bench.shape.expressions * (weights + bench.texels() * bench.shape.channels));
}

void differenceTextureRange(benchmark::State& state) {
  TextureBench bench(state);
  bench.textures.compute(bench.tiles, bench.differences, bench.shape);
  compress::TextureRangeFinder finder(bench.context, kTextures);
  measure(state, [&] { finder.find(bench.tiles, bench.shape, bench.textures.textures(), 0, bench.tiles.tileCount()); });
  setBandwidthCounters(state, bench.maskBytes() + bench.textureBytes());
}

void differenceTextureEncode(benchmark::State& state) {
  TextureBench bench(state);
  bench.textures.compute(bench.tiles, bench.differences, bench.shape);
  const std::vector<compress::TextureEncoding> encoding(static_cast<std::size_t>(kTextures * bench.shape.channels),
                                                        {1.0f, -128.0f});
  std::vector<std::byte> codes(static_cast<std::size_t>(bench.texels()) * encoding.size());
  compress::TextureEncoder encoder(bench.context, kTextures);
  measure(state,
          [&] { encoder.encode(bench.tiles, bench.shape, bench.textures.textures(), encoding, /* bits= */ 8, codes); });
  setBandwidthCounters(state, bench.textureBytes() + static_cast<double>(codes.size()));
}

void arguments(benchmark::internal::Benchmark* row) {
  row->ArgNames({"R", "N", "K"})->UseManualTime()->Unit(benchmark::kMillisecond);
  row->Args({256, 20, 53})->Args({1024, 20, 53})->Args({2048, 8, 53});
  row->Args({1024, 20, 16})->Args({1024, 20, 128})->Args({512, 100, 53});
}
BENCHMARK(differenceTexture)->Name("difference_texture")->Apply(arguments);
BENCHMARK(differenceTextureRange)->Name("difference_texture_range")->Apply(arguments);
BENCHMARK(differenceTextureEncode)->Name("difference_texture_encode")->Apply(arguments);

}  // namespace
}  // namespace facezip::bench
