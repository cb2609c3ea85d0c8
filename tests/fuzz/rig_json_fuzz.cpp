// rig.json.
#include "fuzz_input.hpp"
#include "rig/rig_json.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace facezip;
  fuzz::refuseOrRead([&] { rig::parseRig(fuzz::textOf(data, size), "rig.json"); });
  return 0;
}
