// capture.json.
#include "capture/capture_json.hpp"

#include "facezip/error.hpp"
#include "fuzz_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    facezip::readCaptureJson(facezip::fuzz::fileOf("capture.json", data, size));
  } catch (const facezip::InputError&) {
  }
  return 0;
}
