// Models that `train` wrote: every block is checked against the others.
#include "fuzz_input.hpp"
#include "learn/face_model.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace facezip;
  const fuzz::MemoryFile file(data, size);
  fuzz::refuseOrRead([&] { learn::readModel(file.path()); });
  return 0;
}
