#include "flow/texture_flow.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "flow/flow_sampling.hpp"

namespace facezip::flow {
namespace {

constexpr double kMissed = 0.7;  // texels, by which trust falls to 1 / e
constexpr double kUnlike = 0.2;  // agreement at which it is none, ...
constexpr double kAlike = 0.6;   // ... and from which it is whole: noise takes its share of skin's, too

}  // namespace

double trustOf(const TextureFlow& flow, int x, int y) {
  const double missed = missedBy(flow, x, y) / kMissed;
  const double agreement = double{flow.agreement[texelAt(flow, x, y) / 2]};
  return std::exp(-missed * missed) * std::clamp((agreement - kUnlike) / (kAlike - kUnlike), 0.0, 1.0);
}

float missedBy(const TextureFlow& flow, int x, int y) {
  const float* there = &flow.forward[texelAt(flow, x, y)];
  const Bilinear at(x + there[0], y + there[1], flow.width, flow.height);
  if (!at.inside) return std::numeric_limits<float>::infinity();
  const auto back = [&](int axis) {
    return at.mean(
        [&](int i, int j) { return double{flow.backward[texelAt(flow, i, j) + static_cast<std::size_t>(axis)]}; });
  };
  return static_cast<float>(std::hypot(there[0] + back(0), there[1] + back(1)));
}

}  // namespace facezip::flow
