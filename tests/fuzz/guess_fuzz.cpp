// Guesses of a rig's weights, as a table and as JSON.
#include <cstdlib>

#include "facezip/error.hpp"
#include "fuzz_file.hpp"
#include "rig/weight_guess.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace facezip;
  for (const char* name : {"guess.csv", "guess.json"}) {
    try {
      const Eigen::MatrixXd weights =
          rig::readGuess(fuzz::fileOf(name, data, size), {"smile", "frown"}, {"jawOpen", "browInnerUp", "a"});
      if (weights.rows() != 2 || weights.cols() != 3) std::abort();
      if (!(weights.minCoeff() >= 0.0 && weights.maxCoeff() <= 1.0)) std::abort();
    } catch (const InputError&) {
    }
  }
  return 0;
}
