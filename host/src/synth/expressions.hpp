// expressions.hpp - which expressions a synthetic subject performs, and how.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "synth/actions.hpp"

namespace facezip::synth {

struct Expression {
  std::string name;
  std::vector<WeightedAction> actions;
  double flush = 0.0;      ///< blood in cheeks and nose: positive is red, negative is pale; about -1..1
  std::uint64_t take = 0;  ///< seed of what is peculiar to this one performance and scan
};

/// The first `count` (1..100) expressions of a subject: 20 classical ones, then every single action, then pairs of an
/// upper-face and a lower-face action drawn from the seed. Names are unique; the first n do not depend on `count`.
std::vector<Expression> makeExpressions(int count, std::uint64_t seed);

}  // namespace facezip::synth
