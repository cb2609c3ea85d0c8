// Clips of weights: each frame has a finite weight for each expression.
#include <cmath>
#include <cstdlib>

#include "facezip/blend.hpp"
#include "fuzz_input.hpp"
#include "fuzz_package.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace facezip;
  fuzz::refuseOrRead([&] {
    const AnimationClip clip = readAnimation(fuzz::fileOf("clip.csv", data, size), fuzz::package());
    if (clip.frames() < 1) std::abort();
    for (int f = 0; f < clip.frames(); ++f) {
      if (clip.frame(f).size() != fuzz::package().expressions().size()) std::abort();
      for (const float weight : clip.frame(f)) {
        if (!(std::abs(weight) <= kLargestWeight)) std::abort();
      }
    }
  });
  return 0;
}
