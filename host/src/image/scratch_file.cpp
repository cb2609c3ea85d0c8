#include "image/scratch_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "facezip/error.hpp"
#include "io/file_at.hpp"

namespace facezip::image {
namespace fs = std::filesystem;

ScratchFile::ScratchFile(const fs::path& directory) : directory_(directory) {
  std::string pattern = (directory / ".facezip-scratch-XXXXXX").string();
  descriptor_ = ::mkstemp(pattern.data());
  if (descriptor_ < 0) throw OutputError(directory, std::strerror(errno), "choose another --output");
  ::unlink(pattern.c_str());
}

ScratchFile::~ScratchFile() { ::close(descriptor_); }

void ScratchFile::write(std::size_t offset, std::span<const std::byte> bytes) {
  const std::string fault = io::writeAt(descriptor_, offset, bytes);
  if (!fault.empty()) throw OutputError(directory_, fmt::format("scratch file: {}", fault), "free some space");
}

void ScratchFile::read(std::size_t offset, std::span<std::byte> bytes) const {
  const std::string fault = io::readAt(descriptor_, offset, bytes);
  if (!fault.empty()) throw OutputError(directory_, fmt::format("scratch file: {}", fault));
}

std::size_t ScratchFile::freeBytes(const fs::path& directory) {
  struct statvfs status {};
  if (::statvfs(directory.c_str(), &status) != 0) return 0;
  return static_cast<std::size_t>(status.f_bavail) * static_cast<std::size_t>(status.f_frsize);
}

}  // namespace facezip::image
