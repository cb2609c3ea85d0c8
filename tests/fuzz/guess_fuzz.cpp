// Guesses of a rig's weights, as a table and as JSON.
#include <cstdlib>

#include "fuzz_file.hpp"
#include "fuzz_input.hpp"
#include "rig/weight_guess.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace facezip;
  for (const char* name : {"guess.csv", "guess.json"}) {
    fuzz::refuseOrRead([&] {
      const Eigen::MatrixXd weights =
          rig::readGuess(fuzz::fileOf(name, data, size), {"smile", "frown"}, {"jawOpen", "browInnerUp", "a"});
      if (weights.rows() != 2 || weights.cols() != 3) std::abort();
      if (!(weights.minCoeff() >= 0.0 && weights.maxCoeff() <= 1.0)) std::abort();
    });
  }
  return 0;
}
