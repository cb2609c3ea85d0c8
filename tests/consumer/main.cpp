// A program of somebody else's: compresses a capture and blends one frame with the installed library.
#include <facezip/blend.hpp>
#include <facezip/compress.hpp>

int main(int, char** argv) {
  facezip::Progress progress;
  const facezip::Device device = facezip::openDevice();
  facezip::compressCapture(facezip::openCapture(argv[1]), argv[2], {}, device, progress);
  const facezip::Package package = facezip::Package::open(argv[2]);
  facezip::Blender blender(package, device);
  blender.setWeights(facezip::weightsByName(package, {{package.expressions().front(), 0.5f}}));
  std::vector<std::byte> frame(package.maps()[0].frameBytes());
  blender.blend(0, frame);
}
