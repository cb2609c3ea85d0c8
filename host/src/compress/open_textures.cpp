#include "compress/open_textures.hpp"

#include <fmt/format.h>

#include <stop_token>
#include <vector>

#include "image/scratch_file.hpp"

namespace facezip::compress {

OpenTextures openTextures(const Capture& capture, const std::filesystem::path& scratch_directory,
                          const device::Run& run) {
  OpenTextures textures;
  textures.maps = openMaps(capture);
  std::uint64_t decoded_bytes = 0;
  for (const OpenMap& map : textures.maps.maps) {
    decoded_bytes += map.samples->decodedBytes();
    if (const std::string mixed = map.samples->mixedColours(); !mixed.empty()) run.progress.note(mixed);
  }
  // Room for the package itself is kept free: it is never larger than the decoded textures.
  if (image::ScratchFile::freeBytes(scratch_directory) < 2 * decoded_bytes) {
    textures.decoded = "decoded again";
    run.progress.note(
        fmt::format("no room for {} MB of decoded textures beside the package: decoding them in every pass",
                    decoded_bytes / 1000000));
    return textures;
  }
  textures.decoded = "scratch file";
  std::vector<image::SampleBands*> samples;  // stay where they are when the maps move
  for (OpenMap& map : textures.maps.maps) {
    map.samples->keepDecoded(scratch_directory);
    samples.push_back(map.samples.get());
  }
  textures.decoder = std::jthread([samples](const std::stop_token& stop) {
    for (image::SampleBands* one : samples) one->decode(stop);
  });
  return textures;
}

}  // namespace facezip::compress
