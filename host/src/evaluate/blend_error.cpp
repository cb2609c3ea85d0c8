#include "evaluate/blend_error.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

#include "bands/covered_texels.hpp"
#include "search/counter_hash.hpp"

namespace facezip::evaluate {
namespace {

constexpr int kMostAtOnce = 5;
constexpr double kLargestSum = 2.0;
/// Keeps these draws apart from those of the compression, which shares the seed.
constexpr std::uint64_t kDomain = 0x626c656e64u;  // "blend"

/// The random numbers of one weight vector.
class Draws {
 public:
  Draws(std::uint64_t seed, int vector) : seed_(seed), vector_(static_cast<std::uint64_t>(vector)) {}
  std::uint64_t bits() { return compress::counterHash(seed_, kDomain, vector_, next_++); }
  int below(int count) { return static_cast<int>(compress::boundedDraw(bits(), static_cast<std::uint32_t>(count))); }
  /// Uniform in (0, 1].
  double uniform() { return static_cast<double>((bits() >> 11) + 1) * 0x1p-53; }

 private:
  std::uint64_t seed_;
  std::uint64_t vector_;
  std::uint64_t next_ = 0;
};

std::vector<float> randomWeights(Draws draws, int expressions) {
  const int active = std::min(expressions, 1 + draws.below(kMostAtOnce));
  std::vector<int> order(static_cast<std::size_t>(expressions));
  std::iota(order.begin(), order.end(), 0);
  std::vector<double> weights(static_cast<std::size_t>(active));
  for (int i = 0; i < active; ++i) {
    std::swap(order[static_cast<std::size_t>(i)], order[static_cast<std::size_t>(i + draws.below(expressions - i))]);
    weights[static_cast<std::size_t>(i)] = draws.uniform();
  }
  const double scale = kLargestSum * draws.uniform() / std::accumulate(weights.begin(), weights.end(), 0.0);
  std::vector<float> beta(static_cast<std::size_t>(expressions), 0.0f);
  for (std::size_t i = 0; i < weights.size(); ++i) {
    beta[static_cast<std::size_t>(order[i])] = static_cast<float>(scale * weights[i]);
  }
  return beta;
}

template <typename Sample>
void blendSamples(std::span<const std::byte> samples, const compress::BandShape& shape, std::span<const float> beta,
                  std::span<const std::uint32_t> texels, std::span<float> out) {
  const float unit = image::unit255(shape.sample_type);
  const auto* neutral = reinterpret_cast<const Sample*>(samples.data());
  const auto channels = static_cast<std::size_t>(shape.channels);
  compress::forEachChunk(texels.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      for (std::size_t at = texels[i] * channels; at < (texels[i] + std::size_t{1}) * channels; ++at) {
        const float base = static_cast<float>(neutral[at]);
        float sum = base;
        for (std::size_t n = 0; n < beta.size(); ++n) {
          if (beta[n] == 0.0f) continue;
          sum += beta[n] * (static_cast<float>(neutral[(n + 1) * out.size() + at]) - base);
        }
        out[at] = unit * sum;
      }
    }
  });
}

}  // namespace

std::vector<std::vector<float>> randomWeightVectors(std::uint64_t seed, int count, int expressions) {
  std::vector<std::vector<float>> vectors;
  for (int v = 0; v < count; ++v) vectors.push_back(randomWeights(Draws(seed, v), expressions));
  return vectors;
}

void blendCaptured(std::span<const std::byte> samples, const compress::BandShape& shape, std::span<const float> beta,
                   std::span<const std::uint32_t> texels, std::span<float> out) {
  assert(samples.size() == (beta.size() + 1) * out.size() * image::sampleBytes(shape.sample_type));
  switch (shape.sample_type) {
    case image::SampleType::kUint8:
      return blendSamples<std::uint8_t>(samples, shape, beta, texels, out);
    case image::SampleType::kUint16:
      return blendSamples<std::uint16_t>(samples, shape, beta, texels, out);
    case image::SampleType::kFloat32:
      break;
  }
  blendSamples<float>(samples, shape, beta, texels, out);
}

BlendErrors summarizeBlendErrors(std::span<const ErrorDistribution> errors, std::span<const std::vector<float>> weights,
                                 std::span<const ErrorDistribution> expressions) {
  ErrorDistribution pooled;
  BlendErrors result;
  for (std::size_t v = 0; v < errors.size(); ++v) {
    double bound = 0.0;
    for (std::size_t n = 0; n < expressions.size(); ++n) {
      bound += std::abs(static_cast<double>(weights[v][n])) * expressions[n].rootMeanSquare();
    }
    pooled.add(errors[v]);
    if (bound > 0.0) {
      result.largest_share_of_bound = std::max(result.largest_share_of_bound, errors[v].rootMeanSquare() / bound);
    }
  }
  result.rmse = pooled.rootMeanSquare();
  return result;
}

}  // namespace facezip::evaluate
