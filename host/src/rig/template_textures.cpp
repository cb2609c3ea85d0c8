#include "rig/template_textures.hpp"

#include <fmt/format.h>

#include "capture/capture_json.hpp"
#include "capture/found_maps.hpp"
#include "image/float_image.hpp"
#include "io/staged_directory.hpp"

namespace facezip::rig {
namespace fs = std::filesystem;
namespace {

/// The image of a shape, where the template has one.
fs::path imageOf(const FoundMap& map, const std::string& name) {
  const auto found = map.images.find(name);
  return found == map.images.end() ? fs::path() : found->second;
}

/// How far a shape's texture is from the template's neutral, in 1/255.
image::FloatImage changeOf(const fs::path& shape, const fs::path& file, const image::FloatImage& neutral) {
  image::FloatImage change = image::readFloatImage(shape);
  if (!change.isLike(neutral)) {
    throw InputError(
        {shape.string(), "texture", neutral.sizeText() + " as in " + file.string(), change.sizeText(), ""});
  }
  for (std::size_t i = 0; i < change.samples.size(); ++i) change.samples[i] -= neutral.samples[i];
  return change;
}

}  // namespace

std::vector<CaptureMap> transferTextures(const std::vector<CaptureMap>& subject, const fs::path& template_directory,
                                         const std::vector<std::string>& shapes, const fs::path& folder,
                                         Progress& progress) {
  std::vector<std::string> names;
  for (const CaptureMap& map : subject) names.push_back(map.name);
  const std::map<std::string, FoundMap> found = findMaps(template_directory, {}, names, nullptr);
  std::vector<CaptureMap> textures = subject;
  progress.stage("textures of the template", textures.size() * shapes.size());
  std::size_t done = 0;
  for (CaptureMap& map : textures) {
    map.expressions.assign(shapes.size(), map.neutral);
    const auto source = found.find(map.name);
    if (source == found.end() || imageOf(source->second, "neutral").empty()) continue;
    const fs::path neutral_file = imageOf(source->second, "neutral");
    const image::FloatImage neutral = image::readFloatImage(neutral_file);
    io::createDirectories(folder / map.name);
    for (std::size_t m = 0; m < shapes.size(); ++m) {
      progress.checkCancelled();
      progress.advance(++done);
      const fs::path shape = imageOf(source->second, shapes[m]);
      if (shape.empty()) continue;
      map.expressions[m] = folder / map.name / fmt::format("{}{}", m, image::losslessExtension(map.neutral));
      image::writeChanged(map.neutral, changeOf(shape, neutral_file, neutral), map.expressions[m]);
    }
  }
  return textures;
}

}  // namespace facezip::rig
