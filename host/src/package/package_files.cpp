#include "package/package_files.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <utility>
#include <vector>

#include "package/package_textures.hpp"
#include "package/weight_atlas.hpp"

namespace facezip::package {
namespace {

std::string describe(const image::ImageShape& shape) {
  return fmt::format("{} x {} texels, {} channel{}, {}", shape.width, shape.height, shape.channels,
                     shape.channels == 1 ? "" : "s", image::sampleTypeName(shape.type));
}

/// A PNG ends with an empty IEND chunk; a file that was cut anywhere does not. Decoding it all would find that too, at
/// the price of reading every texel twice.
bool endsAsPng(const InputFile& file) {
  constexpr std::array<char, 12> kEnd = {0, 0, 0, 0, 'I', 'E', 'N', 'D', '\xae', '\x42', '\x60', '\x82'};
  std::array<char, 12> end = {};
  if (file.size() < end.size()) return false;
  const auto offset = static_cast<off_t>(file.size() - end.size());
  return ::pread(file.descriptor(), end.data(), end.size(), offset) == static_cast<ssize_t>(end.size()) && end == kEnd;
}

void requireWhole(image::ImageReader& reader) {
  if (reader.path().extension() == ".png") {
    if (endsAsPng(reader.file())) return;
    throw InputError({reader.path().string(), "", "a whole PNG file", "no IEND at its end",
                      "the file is truncated or damaged: write the package again"});
  }
  // OpenEXR finds rows by a table of offsets: the last rows are missing from a file that was cut, and are cheap to
  // read.
  const image::ImageShape& shape = reader.shape();
  std::vector<std::byte> row(shape.rowBytes());
  reader.readRows(shape.height - 1, shape.height, row);
}

/// Images of a package are not exported again, as those of a capture: the package is written again.
image::ImageReader openReader(const io::Folder& folder, const std::string& file) {
  InputFile opened = folder.open(file, "an image", "the package is damaged: write it again");
  try {
    return image::ImageReader(folder.path() / file, std::move(opened));
  } catch (const InputError& error) {
    InputError::Parts parts = error.parts();
    parts.cure = "the package is damaged: write it again";
    throw InputError(parts);
  }
}

}  // namespace

std::uint64_t checkImage(const io::Folder& folder, const std::string& file, const image::ImageShape& shape) {
  image::ImageReader reader = openImage(folder, file, shape);
  requireWhole(reader);
  return reader.file().size();
}

image::ImageShape neutralShape(const PackageMap& map) { return {map.width, map.height, map.channels, map.sample_type}; }

image::ImageShape differenceShape(const PackageMap& map) {
  return {map.width, map.height, map.channels,
          map.difference_bits == 16 ? image::SampleType::kUint16 : image::SampleType::kUint8};
}

image::ImageReader openImage(const io::Folder& folder, const std::string& file, const image::ImageShape& shape) {
  image::ImageReader reader = openReader(folder, file);
  if (reader.shape() != shape) {
    throw InputError({reader.path().string(), "", describe(shape) + " (package.json)", describe(reader.shape()),
                      "the package was changed: write it again"});
  }
  return reader;
}

std::uint64_t checkTextures(const PackageDescription& description, const io::Folder& folder) {
  std::uint64_t bytes = 0;
  for (const PackageWeights& weights : description.weights) {
    for (std::size_t file = 0; file < weights.files.size(); ++file) {
      bytes +=
          checkImage(folder, weights.files[file], atlasShape(weights, description.differences, static_cast<int>(file)));
    }
  }
  for (const PackageMap& map : description.maps) {
    bytes += checkTexture(folder, neutralTexture(map));
    for (int i = 0; i < description.differences; ++i) bytes += checkTexture(folder, differenceTexture(map, i));
  }
  return bytes;
}

}  // namespace facezip::package
