// compress_capture - makes a package of a capture and says what came out.
//
//   compress_capture CAPTURE PACKAGE [MEGABYTES]
//
// With MEGABYTES, the best package of ASTC blocks that fits into so much memory at run time.
#include <cstdio>
#include <cstdlib>
#include <facezip/facezip.hpp>

int main(int argc, char** argv) {
  if (argc < 3 || argc > 4) {
    std::fprintf(stderr, "usage: compress_capture CAPTURE PACKAGE [MEGABYTES]\n");
    return 2;
  }
  try {
    facezip::CompressOptions options;
    if (argc == 4) {
      options.budget_bytes = static_cast<std::uint64_t>(1e6 * std::atof(argv[3]));
      options.format_choice = {facezip::BlockFormat::kAstc4x4, facezip::BlockFormat::kAstc6x6,
                               facezip::BlockFormat::kAstc8x8, facezip::BlockFormat::kAstc10x10};
    }
    facezip::Progress progress;  // says nothing; derive from it to show a bar, or to cancel
    const facezip::Capture capture = facezip::openCapture(argv[1]);
    const facezip::Device device = facezip::openDevice();  // the first GPU, else the first CPU
    const facezip::CompressReport report = facezip::compressCapture(capture, argv[2], options, device, progress);

    const facezip::Package package = facezip::Package::open(argv[2]);
    std::printf("%zu expressions, %d difference textures, %.2f MB at run time\n", package.expressions().size(),
                package.differences(), static_cast<double>(package.bytesInMemory()) / 1e6);
    for (const auto& [map, rmse] : report.rmse) std::printf("%s: RMSE %.3f of 255\n", map.c_str(), rmse);
    return 0;
  } catch (const facezip::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
