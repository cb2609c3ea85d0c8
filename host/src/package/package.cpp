#include "facezip/package.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cerrno>
#include <chrono>
#include <system_error>
#include <thread>

#include "io/composed.hpp"
#include "io/folder.hpp"
#include "package/guides.hpp"
#include "package/package_files.hpp"
#include "package/package_json.hpp"
#include "package/package_textures.hpp"

namespace facezip {
namespace fs = std::filesystem;
namespace {

constexpr std::uintmax_t kLargestDescription = 64u << 20;  // a package of 65536 expressions stays below
constexpr const char* kWhatItIs = "the description of a facezip package";
constexpr const char* kCure = "name a directory that `facezip compress` wrote";

std::shared_ptr<const io::Folder> openFolder(const fs::path& directory) {
  try {
    return std::make_shared<const io::Folder>(directory);
  } catch (const std::system_error& error) {
    const int code = error.code().value();
    const std::string reason = code == ENOENT || code == ENOTDIR ? "no such file" : error.code().message();
    throw InputError({(directory / package::kDescriptionFile).string(), "", kWhatItIs, reason, kCure});
  }
}

}  // namespace

std::size_t PackageMap::frameBytes() const {
  return static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * static_cast<std::size_t>(channels) *
         image::sampleBytes(sample_type);
}

Package Package::openOnce(const fs::path& directory) {
  Package package;
  package.folder_ = openFolder(directory);
  package.directory_ = directory;
  const std::string text = package.folder_->open(package::kDescriptionFile, kWhatItIs, kCure).read(kLargestDescription);
  package.description_ = package::parsePackageJson(text, (directory / package::kDescriptionFile).string());
  package.bytes_on_disk_ = text.size() + package::checkTextures(package.description_, *package.folder_) +
                           package::checkGuides(package.description_, *package.folder_);
  return package;
}

ProtectedPaths inputsOf(const Package& package) {
  return ProtectedPaths().add(package.directory(), "the package that is read");
}

Package Package::open(const fs::path& directory) {
  std::error_code ignored;
  const bool is_description =
      directory.filename() == package::kDescriptionFile && !fs::is_directory(directory, ignored);
  const fs::path folder = is_description ? directory.parent_path() : directory;
  // Where another package takes its place, its files go before they are read: then that one is opened.
  constexpr int kMostTries = 50;
  for (int tries = 1;; ++tries) {
    const std::shared_ptr<const io::Folder> before = openFolder(folder);
    try {
      return openOnce(folder);
    } catch (const InputError&) {
      if (tries == kMostTries || !before->wasReplaced()) throw;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
}

bool Package::wasReplaced() const { return folder_->wasReplaced(); }

int Package::mapIndex(const std::string& map_name) const {
  const std::string wanted = io::composed(map_name);
  std::vector<std::string> names;
  for (std::size_t m = 0; m < maps().size(); ++m) {
    if (maps()[m].name == wanted) return static_cast<int>(m);
    names.push_back(maps()[m].name);
  }
  throw InputError({directory_.string(), "map", fmt::format("{}", fmt::join(names, ", ")), map_name, ""});
}

std::uint64_t Package::bytesInMemory() const {
  std::uint64_t bytes = 0;
  for (const PackageMap& map : maps()) {
    bytes += package::bytesInMemory(package::neutralTexture(map));
    for (int i = 0; i < differences(); ++i) bytes += package::bytesInMemory(package::differenceTexture(map, i));
  }
  for (const PackageWeights& weights : weightSets()) {
    const std::uint64_t cells =
        static_cast<std::uint64_t>(weights.tile_width) * static_cast<std::uint64_t>(weights.tile_height);
    bytes += cells * expressions().size() * static_cast<std::uint64_t>(differences());
  }
  return bytes;
}

}  // namespace facezip
