// DDS files: every row of blocks of every level, the last first.
#include "fuzz_texture.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  facezip::fuzz::readTexture("texture.dds", data, size);
  return 0;
}
