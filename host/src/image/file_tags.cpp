// file_tags.cpp - what files say of their samples beside them. Apart from image_file.cpp, so that the module of
// OpenImageIO links it alone.
#include <fmt/format.h>

#include <cstdint>

#include "facezip/error.hpp"
#include "image/image_format.hpp"

namespace facezip::image {
namespace fs = std::filesystem;

std::string profileName(const std::string& name, std::span<const std::byte> profile) {
  std::uint32_t sum = 2166136261u;  // FNV-1a: enough to tell profiles of one name apart
  for (const std::byte b : profile) sum = (sum ^ std::to_integer<std::uint32_t>(b)) * 16777619u;
  return fmt::format("ICC profile {} ({:08x})", name, sum);
}

void requireUpright(const fs::path& path, int orientation) {
  if (orientation == 1) return;
  constexpr const char* kAsks[] = {"mirrored",
                                   "turned by 180 degrees",
                                   "flipped",
                                   "turned and mirrored",
                                   "turned by 90 degrees clockwise",
                                   "turned and mirrored",
                                   "turned by 90 degrees counterclockwise"};
  throw InputError({path.string(), "orientation tag", "1, rows as they are stored",
                    orientation >= 2 && orientation <= 8
                        ? fmt::format("{}, the image is to be shown {}", orientation, kAsks[orientation - 2])
                        : fmt::format("{}", orientation),
                    "apply it and export the image again, without the tag"});
}

}  // namespace facezip::image
