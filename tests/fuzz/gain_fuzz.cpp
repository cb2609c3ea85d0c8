// Presets of gains.
#include "facezip/gain.hpp"

#include <cmath>
#include <cstdlib>

#include "facezip/error.hpp"
#include "fuzz_package.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace facezip;
  try {
    const Gain gain = readGain(fuzz::fileOf("gain.json", data, size), fuzz::package());
    if (gain.expressions.size() != fuzz::package().expressions().size()) std::abort();
    for (const float factor : gain.expressions) {
      if (!(factor >= 0.0f) || !std::isfinite(factor)) std::abort();
    }
  } catch (const InputError&) {
  }
  return 0;
}
