// Rows of the encoders and decoders of blocks, in texels a second, and libastcenc's in the same run: what a studio
// would code every texture with.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <functional>

#include "blocks/astc_encoder.hpp"
#include "blocks/bc_encoder.hpp"
#include "blocks/block_decoder.hpp"
#include "blocks/device_block_decoder.hpp"
#include "photograph_like.hpp"
#include "roof.hpp"

namespace facezip::bench {
namespace {

using blocks::BlockFormat;
using blocks::Quality;

constexpr int kChannels = 3;

double processSeconds() {
  timespec time{};
  ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_nsec) * 1e-9;
}

/// Counters "Mtexel/s" of the best iteration, and "Mtexel/cpu_s", a second of processor time of all threads: the one to
/// compare by where other work shares the machine.
void measureTexels(benchmark::State& state, int side, const std::function<void()>& step) {
  double least = 1e9;
  measure(state, [&] {
    const double begin = processSeconds();
    step();
    least = std::min(least, processSeconds() - begin);
  });
  const double mega_texels = static_cast<double>(side) * side / 1e6;
  state.counters["Mtexel/s"] = mega_texels / (state.counters["best_ms"].value * 1e-3);
  state.counters["Mtexel/cpu_s"] = mega_texels / least;
}

std::vector<float> photograph(int side, int channels) {
  const std::vector<std::uint8_t> bytes = test::photographLike(side, side);
  std::vector<float> texels;
  for (std::size_t p = 0; p < bytes.size() / 3; ++p) {
    for (int c = 0; c < channels; ++c) texels.push_back(static_cast<float>(bytes[3 * p + static_cast<std::size_t>(c)]));
  }
  return texels;
}

double rmse(std::span<const float> texels, std::span<const float> decoded) {
  double sum = 0.0;
  for (std::size_t i = 0; i < texels.size(); ++i) sum += std::pow(static_cast<double>(texels[i] - decoded[i]), 2.0);
  return std::sqrt(sum / static_cast<double>(texels.size()));
}

/// From device memory to device memory, as the closed loop codes.
void bcEncode(benchmark::State& state, BlockFormat format) {
  device::DeviceContext& context = benchDevice();
  const int side = static_cast<int>(state.range(0));
  const int channels = std::min(kChannels, blocks::infoOf(format).max_channels);
  const std::vector<float> samples = photograph(side, channels);
  blocks::BcEncoder encoder(context, {format, channels, static_cast<Quality>(state.range(1))});
  blocks::DeviceTexels texels;
  texels.layout = blocks::TexelLayout::interleaved(side, side, channels);
  texels.samples = context.upload(samples, "texels");
  const cl::Buffer coded = context.allocate(blocks::blockBytes(format, side, side), CL_MEM_READ_WRITE, "blocks");
  const cl::Buffer decoded = context.allocate(samples.size() * sizeof(float), CL_MEM_READ_WRITE, "decoded");
  measureTexels(state, side, [&] {
    encoder.encodeOnDevice(texels, coded, decoded);
    context.finish();
  });
  std::vector<float> result(samples.size());
  context.read(decoded, result, "decoded");
  state.counters["rmse"] = rmse(samples, result);
}

void bcDecode(benchmark::State& state, BlockFormat format) {
  device::DeviceContext& context = benchDevice();
  const int side = static_cast<int>(state.range(0));
  const int channels = std::min(kChannels, blocks::infoOf(format).max_channels);
  blocks::BcEncoder encoder(context, {format, channels, Quality::kFast});
  blocks::DeviceTexels texels;
  texels.layout = blocks::TexelLayout::interleaved(side, side, channels);
  texels.samples = context.upload(photograph(side, channels), "texels");
  const cl::Buffer coded = context.allocate(blocks::blockBytes(format, side, side), CL_MEM_READ_WRITE, "blocks");
  encoder.encodeOnDevice(texels, coded, {});
  const cl::Buffer decoded = context.allocate(
      static_cast<std::size_t>(side) * static_cast<std::size_t>(side * channels), CL_MEM_READ_WRITE, "decoded");
  measureTexels(state, side, [&] {
    blocks::decodeOnDevice(context, format, channels, coded, texels.layout, blocks::DecodedType::kUint8, decoded);
    context.finish();
  });
}

void hostDecode(benchmark::State& state, BlockFormat format) {
  const int side = static_cast<int>(state.range(0));
  const int channels = std::min(kChannels, blocks::infoOf(format).max_channels);
  const std::vector<float> samples = photograph(side, channels);
  std::vector<std::byte> coded(blocks::blockBytes(format, side, side));
  blocks::makeBlockEncoder(benchDevice(), {format, channels, Quality::kFast})
      ->encode({side, side, channels, std::span<const float>(samples), {}}, coded, {});
  std::vector<std::uint8_t> decoded(samples.size());
  const auto decoder = blocks::makeBlockDecoder(format, channels);
  measureTexels(state, side, [&] { decoder->decode(side, side, coded, std::span(decoded)); });
}

/// libastcenc as `astcenc -fast` (10) and `-medium` (60) run it: bytes in, its own idea of enough.
void astcEncode(benchmark::State& state) {
  const int side = static_cast<int>(state.range(0));
  const std::vector<std::uint8_t> bytes = test::photographLike(side, side);
  blocks::EncoderOptions options{BlockFormat::kAstc6x6, kChannels};
  options.astc_effort = blocks::AstcEffort{static_cast<float>(state.range(1)), {}};
  blocks::AstcEncoder encoder(options);
  std::vector<std::byte> coded(blocks::blockBytes(options.format, side, side));
  measureTexels(state, side, [&] {
    encoder.encode({side, side, kChannels, std::span<const std::uint8_t>(bytes), {}}, coded, {});
  });
  std::vector<float> decoded(bytes.size());
  encoder.encode({side, side, kChannels, std::span<const std::uint8_t>(bytes), {}}, coded, decoded);
  state.counters["rmse"] = rmse(photograph(side, kChannels), decoded);
}

void efforts(benchmark::internal::Benchmark* row) {
  row->ArgNames({"R", "quality"})->UseManualTime()->Unit(benchmark::kMillisecond);
  for (const int quality : {0, 1, 2}) row->Args({1024, quality});
  row->Args({2048, 0});
}
void sizes(benchmark::internal::Benchmark* row) {
  row->ArgNames({"R"})->UseManualTime()->Unit(benchmark::kMillisecond)->Arg(1024)->Arg(2048);
}
void presets(benchmark::internal::Benchmark* row) {
  row->ArgNames({"R", "preset"})->UseManualTime()->Unit(benchmark::kMillisecond)->Args({1024, 10})->Args({1024, 60});
}
BENCHMARK_CAPTURE(bcEncode, bc1, BlockFormat::kBc1)->Name("bc1_encode")->Apply(efforts);
BENCHMARK_CAPTURE(bcEncode, bc4, BlockFormat::kBc4)->Name("bc4_encode")->Apply(efforts);
BENCHMARK_CAPTURE(bcEncode, bc7, BlockFormat::kBc7)->Name("bc7_encode")->Apply(efforts);
BENCHMARK(astcEncode)->Name("astcenc_6x6")->Apply(presets);
BENCHMARK_CAPTURE(bcDecode, bc1, BlockFormat::kBc1)->Name("block_decode_bc1")->Apply(sizes);
BENCHMARK_CAPTURE(bcDecode, bc7, BlockFormat::kBc7)->Name("block_decode_bc7")->Apply(sizes);
BENCHMARK_CAPTURE(hostDecode, bc7, BlockFormat::kBc7)->Name("host_decode_bc7")->Apply(sizes);
BENCHMARK_CAPTURE(hostDecode, astc, BlockFormat::kAstc6x6)->Name("host_decode_astc_6x6")->Apply(sizes);

}  // namespace
}  // namespace facezip::bench
