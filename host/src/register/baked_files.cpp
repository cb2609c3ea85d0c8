#include "register/baked_files.hpp"

#include <fmt/format.h>

#include "facezip/error.hpp"
#include "image/set_sample.hpp"
#include "io/counts.hpp"
#include "io/write_file.hpp"
#include "register/hole_filling.hpp"

namespace facezip::registration {
namespace fs = std::filesystem;

void writeTexture(const fs::path& folder, const std::string& name, const BakedTexture& texture) {
  io::createDirectories(folder);
  const bool is_float = texture.type == image::SampleType::kFloat32;
  image::Image out{{texture.side, texture.side, texture.channels, texture.type}, {}};
  out.samples.resize(toSize(texture.side) * out.shape.rowBytes());
  for (std::size_t i = 0; i < texture.samples.size(); ++i) image::setSample(out, i, texture.samples[i]);
  image::writeImage(folder / (name + (is_float ? ".exr" : ".png")), out);
}

void writeConfidence(const fs::path& folder, const std::string& name, const BakedTexture& texture) {
  io::createDirectories(folder);
  image::Image out{{texture.side, texture.side, 1, image::SampleType::kUint8}, {}};
  const auto bytes = std::as_bytes(std::span(texture.confidence));
  out.samples.assign(bytes.begin(), bytes.end());
  image::writeImage(folder / (name + ".png"), out);
}

void fillTexture(BakedTexture& texture, const BakedTexture* neutral) {
  if (neutral != nullptr) {
    for (std::size_t i = 0; i < texture.samples.size(); ++i) texture.samples[i] -= neutral->samples[i];
  }
  fillHoles(texture.samples, texture.channels, texture.side, texture.side, texture.confidence);
  if (neutral != nullptr) {
    for (std::size_t i = 0; i < texture.samples.size(); ++i) texture.samples[i] += neutral->samples[i];
  }
}

void requireSameChannels(const BakedTexture& texture, const BakedTexture& neutral, const fs::path& file) {
  if (texture.channels == neutral.channels && texture.type == neutral.type) return;
  throw InputError(
      {file.string(), "texture",
       fmt::format("{} channels of {} as the neutral's", neutral.channels, image::sampleTypeName(neutral.type)),
       fmt::format("{} of {}", texture.channels, image::sampleTypeName(texture.type)), ""});
}

double coverageOf(const BakedTexture& texture, const std::vector<bool>& region) {
  std::size_t shown = 0, wanted = 0;
  for (std::size_t i = 0; i < region.size(); ++i) {
    if (!region[i]) continue;
    ++wanted;
    shown += texture.confidence[i] > 0 ? 1 : 0;
  }
  return wanted == 0 ? 0.0 : static_cast<double>(shown) / static_cast<double>(wanted);
}

}  // namespace facezip::registration
