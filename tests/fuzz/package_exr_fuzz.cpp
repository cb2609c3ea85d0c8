// EXR of packages. OpenEXR's own faults are not ours to mend, but ours to know of.
#include <vector>

#include "fuzz_input.hpp"
#include "image/image_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace facezip;
  const fuzz::MemoryFile file(data, size);
  fuzz::refuseOrRead([&] {
    image::ImageReader reader("image.exr", file.open());
    const image::ImageShape& shape = reader.shape();
    constexpr std::size_t kMostBytes = std::size_t{16} << 20;
    if (shape.rowBytes() * static_cast<std::size_t>(shape.height) > kMostBytes) return;
    std::vector<std::byte> row(shape.rowBytes());
    for (int y = 0; y < shape.height; ++y) reader.readRows(y, y + 1, row);
  });
  return 0;
}
