#include "image/output_formats.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <string>
#include <string_view>
#include <vector>

#include "facezip/error.hpp"

namespace facezip::image {
namespace {

struct Format {
  std::string_view extension;
  std::vector<int> channels;
  std::vector<SampleType> types;
};

const std::vector<Format>& formats() {
  using enum SampleType;
  static const std::vector<Format> all = {{".png", {1, 2, 3, 4}, {kUint8, kUint16}},
                                          {".tif", {1, 2, 3, 4}, {kUint8, kUint16, kFloat32}},
                                          {".tiff", {1, 2, 3, 4}, {kUint8, kUint16, kFloat32}},
                                          {".exr", {1, 2, 3, 4}, {kUint8, kFloat32}},
                                          {".tga", {1, 3, 4}, {kUint8}},
                                          {".bmp", {3, 4}, {kUint8}},
                                          {".jpg", {1, 3}, {kUint8}},
                                          {".jpeg", {1, 3}, {kUint8}}};
  return all;
}

std::string extensionOf(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  std::ranges::transform(extension, extension.begin(), [](unsigned char c) { return std::tolower(c); });
  return extension;
}

std::string described(const ImageShape& shape) {
  return fmt::format("{} channel{} of {}", shape.channels, shape.channels == 1 ? "" : "s", sampleTypeName(shape.type));
}

}  // namespace

void requireFormat(const std::filesystem::path& file, const ImageShape& shape) {
  const std::string extension = extensionOf(file);
  const auto format = std::ranges::find(formats(), extension, &Format::extension);
  if (format == formats().end()) {
    std::vector<std::string_view> extensions;
    for (const Format& known : formats()) extensions.push_back(known.extension);
    throw InputError({file.string(), "", fmt::format("a file name that ends in {}", fmt::join(extensions, ", ")),
                      fmt::format("\"{}\"", extension), ""});
  }
  if (std::ranges::count(format->channels, shape.channels) > 0 && std::ranges::count(format->types, shape.type) > 0) {
    return;
  }
  throw InputError({file.string(), "", "a format for " + described(shape),
                    fmt::format("\"{}\", which would lose some of it", extension),
                    shape.type == SampleType::kFloat32 ? "use .exr or .tif" : "use .png or .tif"});
}

}  // namespace facezip::image
