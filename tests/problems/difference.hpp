// difference.hpp - problem of the step `difference`.
#pragma once

#include "problems/band.hpp"

namespace facezip::test {

/// Must move: the samples once in, the differences once out.
struct DifferenceProblem : BandProblem {
  using BandProblem::BandProblem;

  void run() {
    compress::computeDifferences(context, tiles, shape, device_samples, differences.buffer());
    context.finish();
  }
  std::vector<double> result() const {
    if (shape.differenceBytes() == 2) {
      const std::vector<cl_short> values = differences.read<cl_short>();
      return {values.begin(), values.end()};
    }
    const std::vector<float> values = differences.read<float>();
    return {values.begin(), values.end()};
  }
  const std::vector<double>& expected() const { return delta(); }

  double bytes() const { return sampleBytes() + differenceBytes(); }
};

}  // namespace facezip::test
