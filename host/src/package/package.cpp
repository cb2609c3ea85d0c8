#include "facezip/package.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <system_error>

#include "io/read_file.hpp"
#include "package/guides.hpp"
#include "package/package_files.hpp"
#include "package/package_json.hpp"

namespace facezip {
namespace fs = std::filesystem;
namespace {

std::string readDescription(const fs::path& file) {
  constexpr std::uintmax_t kLargest = 64u << 20;  // a package of 65536 expressions stays below
  std::error_code ignored;
  if (fs::is_fifo(file, ignored)) throw InputError({file.string(), "", "a file", "a pipe", ""});
  return io::readFile(file, "the description of a facezip package", "name a directory that `facezip compress` wrote",
                      kLargest);
}

}  // namespace

std::size_t PackageMap::frameBytes() const {
  return static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * static_cast<std::size_t>(channels) *
         image::sampleBytes(sample_type);
}

Package Package::open(const fs::path& directory) {
  Package package;
  std::error_code ignored;
  package.directory_ = directory.filename() == package::kDescriptionFile && !fs::is_directory(directory, ignored)
                           ? directory.parent_path()
                           : directory;
  const fs::path file = package.directory_ / package::kDescriptionFile;
  const std::string text = readDescription(file);
  package.description_ = package::parsePackageJson(text, file.string());
  package.bytes_on_disk_ = text.size() + package::checkImages(package.description_, package.directory_) +
                           package::checkGuides(package.description_, package.directory_);
  return package;
}

ProtectedPaths inputsOf(const Package& package) {
  return ProtectedPaths().add(package.directory(), "the package that is read");
}

int Package::mapIndex(const std::string& map_name) const {
  std::vector<std::string> names;
  for (std::size_t m = 0; m < maps().size(); ++m) {
    if (maps()[m].name == map_name) return static_cast<int>(m);
    names.push_back(maps()[m].name);
  }
  throw InputError({directory_.string(), "map", fmt::format("{}", fmt::join(names, ", ")), map_name, ""});
}

std::uint64_t Package::bytesInMemory() const {
  std::uint64_t bytes = 0;
  for (const PackageMap& map : maps()) {
    const std::uint64_t samples = map.frameBytes() / image::sampleBytes(map.sample_type);
    const auto code_bytes = static_cast<std::uint64_t>(map.difference_bits / 8);
    bytes += map.frameBytes() + samples * code_bytes * static_cast<std::uint64_t>(differences());
  }
  for (const PackageWeights& weights : weightSets()) {
    const std::uint64_t cells =
        static_cast<std::uint64_t>(weights.tile_width) * static_cast<std::uint64_t>(weights.tile_height);
    bytes += cells * expressions().size() * static_cast<std::uint64_t>(differences());
  }
  return bytes;
}

}  // namespace facezip
