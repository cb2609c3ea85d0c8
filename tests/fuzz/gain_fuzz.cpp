// Presets of gains.
#include <cmath>
#include <cstdlib>

#include "facezip/gain.hpp"
#include "fuzz_input.hpp"
#include "fuzz_package.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace facezip;
  fuzz::refuseOrRead([&] {
    const Gain gain = readGain(fuzz::fileOf("gain.json", data, size), fuzz::package());
    if (gain.expressions.size() != fuzz::package().expressions().size()) std::abort();
    for (const float factor : gain.expressions) {
      if (!(factor >= 0.0f) || !std::isfinite(factor)) std::abort();
    }
  });
  return 0;
}
