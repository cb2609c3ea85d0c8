#include "facezip/frame_file.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <string_view>
#include <system_error>
#include <utility>

#include "blend/frame_writer.hpp"
#include "image/image_file.hpp"
#include "image/output_formats.hpp"
#include "io/staged_directory.hpp"
#include "package/package_files.hpp"

namespace facezip {
namespace fs = std::filesystem;

void writeFrame(const fs::path& file, const PackageMap& map, std::span<const std::byte> frame) {
  blend::writeFrameBy(file, map, [&](image::ImageWriter& writer) { writer.writeRows(frame, map.height); });
}

void blend::writeFrameBy(const fs::path& file, const PackageMap& map,
                         const std::function<void(image::ImageWriter& writer)>& write) {
  const image::ImageShape shape = package::neutralShape(map);
  image::requireFormat(file, shape);
  io::createDirectories(fs::absolute(file).parent_path());
  const fs::path target = io::fileToReplace(file);
  if (target.empty()) throw OutputError(file, "something that is no file is in the way", "choose another --output");
  // The extension stays last: it decides the format.
  const fs::path partial = target.parent_path() / fmt::format(".partial-{}-{}", ::getpid(), target.filename().string());
  std::error_code error;
  try {
    image::ImageWriter writer(partial, shape, map.colour_space);
    write(writer);
    writer.close();
    fs::rename(partial, target, error);
    if (error) throw OutputError(file, error.message());
  } catch (...) {
    fs::remove(partial, error);
    throw;
  }
}

FramePattern::FramePattern(std::string pattern, bool numbered, std::size_t maps) : pattern_(std::move(pattern)) {
  findNumber();
  if (numbered && number_begin_ == std::string::npos) {
    throw InputError({"--output", "", "a pattern with the number of the frame, such as frames/%04d.png", pattern_, ""});
  }
  append_map_ = maps > 1 && pattern_.find("{map}") == std::string::npos;
  if (fs::path(pattern_).extension().empty()) {
    throw InputError({"--output", "", "a file name with an extension, such as frame.png", pattern_, ""});
  }
}

/// The first "%d" or "%0Nd" with one digit N, as printf has it; folders may well be called "50%".
void FramePattern::findNumber() {
  for (std::size_t at = pattern_.find('%'); at != std::string::npos; at = pattern_.find('%', at + 1)) {
    const std::string_view rest = std::string_view(pattern_).substr(at);
    const bool padded = rest.size() >= 4 && rest[1] == '0' && rest[2] >= '1' && rest[2] <= '9' && rest[3] == 'd';
    if (!padded && !rest.starts_with("%d")) continue;
    number_begin_ = at;
    number_length_ = padded ? 4 : 2;
    number_width_ = padded ? rest[2] - '0' : 0;
    return;
  }
}

fs::path FramePattern::file(int frame, const std::string& map) const {
  std::string name = pattern_;
  if (number_begin_ != std::string::npos)
    name.replace(number_begin_, number_length_, fmt::format("{:0{}}", frame, number_width_));
  for (std::size_t at = name.find("{map}"); at != std::string::npos; at = name.find("{map}", at + map.size())) {
    name.replace(at, 5, map);
  }
  fs::path path = name;
  if (append_map_) path.replace_extension("." + map + path.extension().string());
  return path;
}

void FramePattern::requireFits(const Package& package) const {
  for (const PackageMap& map : package.maps()) {
    const fs::path first = file(0, map.name);
    image::requireFormat(first, package::neutralShape(map));
    io::requireOutside(first, package.directory(), "the package itself");
  }
}

}  // namespace facezip
