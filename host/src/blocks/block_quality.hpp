// block_quality.hpp - how long encoders look for better blocks.
#pragma once

#include <optional>

namespace facezip::blocks {

/// How long to look for better blocks.
enum class Quality { kFast, kNormal, kBest };

/// libastcenc's knobs.
struct AstcEffort {
  float search = 60.0f;  ///< 0 (its fastest) over 10 (fast), 60 (medium) and 98 (thorough) to 100
  /// A block that errs by no more (RMSE, code units) is not improved any further; none: what libastcenc thinks enough
  /// for the size of the block, which is far from invisible (5.3 for 6 x 6 blocks up to `fast`, 2.4 at `medium`).
  std::optional<float> enough = {};
  /// One partition, candidate and refinement a block. Of 4 x 4 blocks of a difference texture this takes less than half
  /// the time, for 1 % more error; of larger blocks less is saved.
  bool plain = false;
};
AstcEffort astcEffort(Quality quality);

}  // namespace facezip::blocks
