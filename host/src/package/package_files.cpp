#include "package/package_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <vector>

#include "package/weight_atlas.hpp"

namespace facezip::package {
namespace fs = std::filesystem;
namespace {

std::string describe(const image::ImageShape& shape) {
  return fmt::format("{} x {} texels, {} channel{}, {}", shape.width, shape.height, shape.channels,
                     shape.channels == 1 ? "" : "s", image::sampleTypeName(shape.type));
}

/// A PNG ends with an empty IEND chunk; a file that was cut anywhere does not. Decoding it all would find that too, at
/// the price of reading every texel twice.
bool endsAsPng(const fs::path& file) {
  constexpr std::array<char, 12> kEnd = {0, 0, 0, 0, 'I', 'E', 'N', 'D', '\xae', '\x42', '\x60', '\x82'};
  std::array<char, 12> end = {};
  std::ifstream stream(file, std::ios::binary);
  stream.seekg(-static_cast<std::streamoff>(end.size()), std::ios::end);
  return stream.read(end.data(), end.size()) && end == kEnd;
}

void requireWhole(image::ImageReader& reader) {
  const std::string cure = "the file is truncated or damaged: write the package again";
  if (reader.path().extension() == ".png") {
    if (!endsAsPng(reader.path()))
      throw InputError({reader.path().string(), "", "a whole PNG file", "no IEND at its end", cure});
    return;
  }
  // OpenEXR finds rows by a table of offsets: the last rows are missing from a file that was cut, and are cheap to
  // read.
  const image::ImageShape& shape = reader.shape();
  std::vector<std::byte> row(shape.rowBytes());
  reader.readRows(shape.height - 1, shape.height, row);
}

/// Images of a package are not exported again, as those of a capture: the package is written again.
image::ImageReader openReader(const fs::path& file) {
  try {
    return image::ImageReader(file);
  } catch (const InputError& error) {
    InputError::Parts parts = error.parts();
    if (parts.got == std::strerror(EMFILE) || parts.got == std::strerror(EACCES)) throw;
    parts.cure = "the package is damaged: write it again";
    throw InputError(parts);
  }
}

}  // namespace

std::uint64_t checkImage(const fs::path& file, const image::ImageShape& shape) {
  image::ImageReader reader = openImage(file, shape);
  requireWhole(reader);
  return fs::file_size(file);
}

image::ImageShape neutralShape(const PackageMap& map) { return {map.width, map.height, map.channels, map.sample_type}; }

image::ImageShape differenceShape(const PackageMap& map) {
  return {map.width, map.height, map.channels,
          map.difference_bits == 16 ? image::SampleType::kUint16 : image::SampleType::kUint8};
}

image::ImageReader openImage(const fs::path& file, const image::ImageShape& shape) {
  image::ImageReader reader = openReader(file);
  if (reader.shape() != shape) {
    throw InputError({file.string(), "", describe(shape) + " (package.json)", describe(reader.shape()),
                      "the package was changed: write it again"});
  }
  return reader;
}

std::uint64_t checkImages(const PackageDescription& description, const fs::path& directory) {
  std::uint64_t bytes = 0;
  for (const PackageWeights& weights : description.weights) {
    for (std::size_t file = 0; file < weights.files.size(); ++file) {
      bytes += checkImage(directory / weights.files[file],
                          atlasShape(weights, description.differences, static_cast<int>(file)));
    }
  }
  for (const PackageMap& map : description.maps) {
    bytes += checkImage(directory / map.neutral_file, neutralShape(map));
    for (const PackageDifference& difference : map.differences) {
      bytes += checkImage(directory / difference.file, differenceShape(map));
    }
  }
  return bytes;
}

}  // namespace facezip::package
