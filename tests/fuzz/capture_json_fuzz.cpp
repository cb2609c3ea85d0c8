// capture.json.
#include "capture/capture_json.hpp"
#include "fuzz_file.hpp"
#include "fuzz_input.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace facezip;
  fuzz::refuseOrRead([&] { readCaptureJson(fuzz::fileOf("capture.json", data, size)); });
  return 0;
}
