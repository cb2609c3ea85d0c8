#include "facezip/frame_file.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <regex>
#include <system_error>
#include <utility>

#include "image/image_file.hpp"
#include "io/staged_directory.hpp"

namespace facezip {
namespace fs = std::filesystem;

void writeFrame(const fs::path& file, const PackageMap& map, std::span<const std::byte> frame) {
  const fs::path target = fs::absolute(file);
  io::createDirectories(target.parent_path());
  // The extension stays last: it decides the format.
  const fs::path partial = target.parent_path() / fmt::format(".partial-{}-{}", ::getpid(), target.filename().string());
  std::error_code error;
  try {
    image::ImageWriter writer(partial, {map.width, map.height, map.channels, map.sample_type}, map.colour_space);
    writer.writeRows(frame, map.height);
    writer.close();
    fs::rename(partial, target, error);
    if (error) throw OutputError(file, error.message());
  } catch (const Error&) {
    fs::remove(partial, error);
    throw;
  }
}

FramePattern::FramePattern(std::string pattern, bool numbered, std::size_t maps) : pattern_(std::move(pattern)) {
  static const std::regex number("%(0([1-9]))?d");
  std::smatch match;
  if (std::regex_search(pattern_, match, number)) {
    number_begin_ = static_cast<std::size_t>(match.position());
    number_length_ = static_cast<std::size_t>(match.length());
    number_width_ = match[2].matched ? std::stoi(match[2]) : 0;
  } else if (numbered) {
    throw InputError({"--output", "", "a pattern with the number of the frame, such as frames/%04d.png", pattern_, ""});
  }
  append_map_ = maps > 1 && pattern_.find("{map}") == std::string::npos;
  if (fs::path(pattern_).extension().empty()) {
    throw InputError({"--output", "", "a file name with an extension, such as frame.png", pattern_, ""});
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

}  // namespace facezip
