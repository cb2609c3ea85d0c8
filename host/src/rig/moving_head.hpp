// moving_head.hpp - a word to who forgot --head-motion.
#pragma once

#include <fmt/format.h>

#include <string_view>
#include <vector>

#include "facezip/progress.hpp"
#include "facezip/rig.hpp"

namespace facezip::rig {

/// A note where most of what is left of meshes is rigid motion, and it is more than the noise of a tracker.
/// what         "... % of what WHAT is rigid motion"
/// rigid_share  geometry::RigidShare of the same meshes as `residuals`, or of some of them
inline void noteMovingHead(std::string_view what, double rigid_share, const std::vector<RigResidual>& residuals,
                           Progress& progress) {
  constexpr double kMost = 0.5;
  constexpr double kMillimetres = 0.5;
  double mean = 0.0;
  for (const RigResidual& residual : residuals) mean += residual.mean / static_cast<double>(residuals.size());
  if (rigid_share <= kMost || mean <= kMillimetres) return;
  progress.note(
      fmt::format("{:.0f} % of what {} is rigid motion: if the head was not held still, --head-motion takes that out",
                  100.0 * rigid_share, what));
}

}  // namespace facezip::rig
