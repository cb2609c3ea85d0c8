#include "facezip/frame_file.hpp"

#include <fmt/format.h>

#include <set>
#include <string_view>
#include <utility>

#include "blend/frame_writer.hpp"
#include "image/image_file.hpp"
#include "image/input_extensions.hpp"
#include "image/output_formats.hpp"
#include "io/write_file.hpp"
#include "package/package_files.hpp"
#include "package/package_json.hpp"

namespace facezip {
namespace fs = std::filesystem;

namespace {

void writeWhole(const fs::path& file, const image::ImageShape& shape, const std::string& colour_space,
                Progress* progress, const std::function<void(image::ImageWriter& writer)>& write) {
  image::requireFormat(file, shape);
  io::createDirectories(fs::absolute(file).parent_path());
  io::StagedFile staged(file, progress);
  try {
    image::ImageWriter writer(staged.path(), shape, colour_space);
    write(writer);
    writer.close();
  } catch (const OutputError& error) {
    throw error.of(file);
  }
  staged.commit();
}

/// What says that a folder holds the textures of a capture or package: its neutral, and beside the folder what
/// describes it. Empty where nothing does.
std::string signOfTextures(const fs::path& folder) {
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    if (entry.path().stem() != "neutral" || !image::hasImageExtension(entry.path())) continue;
    for (const char* sign : {"capture.json", "neutral.obj", package::kDescriptionFile}) {
      if (fs::exists(folder.parent_path() / sign, error)) return (folder.parent_path() / sign).string();
    }
  }
  return "";
}

}  // namespace

void writeFrame(const fs::path& file, const PackageMap& map, std::span<const std::byte> frame, Progress* progress) {
  blend::writeFrameBy(file, map, progress, [&](image::ImageWriter& writer) { writer.writeRows(frame, map.height); });
}

void blend::writeFrameBy(const fs::path& file, const PackageMap& map, Progress* progress,
                         const std::function<void(image::ImageWriter& writer)>& write) {
  writeWhole(file, package::neutralShape(map), map.colour_space, progress, write);
}

void writePicture(const fs::path& file, int width, int height, std::span<const std::byte> samples) {
  writeWhole(file, {width, height, 3, SampleType::kUint8}, "", nullptr,
             [&](image::ImageWriter& writer) { writer.writeRows(samples, height); });
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

void FramePattern::requireFits(const Package& package, int frames, ProtectedPaths inputs) const {
  inputs.add(inputsOf(package));
  std::set<fs::path> folders;
  for (const PackageMap& map : package.maps()) {
    image::requireFormat(file(0, map.name), package::neutralShape(map));
    for (int frame = 0; frame < frames; ++frame) {
      const fs::path output = file(frame, map.name);
      inputs.requireApart(output);
      const fs::path folder = fs::absolute(output).parent_path();
      if (!folders.insert(folder).second) continue;
      const std::string sign = signOfTextures(folder);
      if (sign.empty()) continue;
      throw OutputError(output, fmt::format("it would be taken for a texture of what {} describes", sign),
                        "choose another --output");
    }
  }
}

}  // namespace facezip
