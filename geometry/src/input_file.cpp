#include "facezip/input_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>
#include <utility>

#include "facezip/error.hpp"

namespace facezip {
namespace fs = std::filesystem;
namespace {

std::string describe(int error) {
  return error == ENOENT || error == ENOTDIR ? "no such file" : std::system_category().message(error);
}

/// Empty for a regular file.
std::string faultOf(const struct stat& status) {
  if (S_ISREG(status.st_mode)) return "";
  if (S_ISDIR(status.st_mode)) return "a folder";
  if (S_ISFIFO(status.st_mode)) return "a pipe";
  return S_ISSOCK(status.st_mode) ? "a socket" : "a device";
}

}  // namespace

// Opening a pipe would wait for a writer.
InputFile::InputFile(const fs::path& file, const std::string& expected, const std::string& cure)
    : InputFile(::open(file.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC), file, expected, cure) {}

InputFile::InputFile(int descriptor, const fs::path& file, const std::string& expected, const std::string& cure)
    : file_(file), expected_(expected), descriptor_(descriptor) {
  if (descriptor_ < 0) {
    const int error = errno;
    throw InputError({file.string(), "", expected, error == ENXIO ? "a socket" : describe(error),
                      error == EMFILE ? "allow more open files (ulimit -n)" : cure});
  }
  struct stat status {};
  const std::string fault = ::fstat(descriptor_, &status) == 0 ? faultOf(status) : describe(errno);
  if (!fault.empty()) {
    ::close(descriptor_);
    throw InputError({file.string(), "", expected, fault, cure});
  }
  size_ = static_cast<std::uintmax_t>(status.st_size);
}

InputFile::~InputFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

InputFile::InputFile(InputFile&& other) noexcept
    : file_(std::move(other.file_)),
      expected_(std::move(other.expected_)),
      descriptor_(std::exchange(other.descriptor_, -1)),
      size_(other.size_) {}

InputFile& InputFile::operator=(InputFile&& other) noexcept {
  std::swap(file_, other.file_);
  std::swap(expected_, other.expected_);
  std::swap(descriptor_, other.descriptor_);
  std::swap(size_, other.size_);
  return *this;
}

std::string InputFile::read(std::uintmax_t most) const {
  const auto refuse = [&](std::uintmax_t bytes) {
    throw InputError(
        {file_.string(), "", fmt::format("{} of at most {} bytes", expected_, most), fmt::format("{}", bytes), ""});
  };
  if (size_ > most) refuse(size_);
  constexpr std::size_t kChunk = std::size_t{1} << 16;
  std::string text;
  text.reserve(static_cast<std::size_t>(size_));
  // To its end, wherever that is: a file may grow, and those of /proc claim to be empty.
  for (std::size_t filled = 0;; text.resize(filled)) {
    text.resize(filled + std::max(kChunk, text.capacity() - filled));
    const ssize_t got = ::pread(descriptor_, text.data() + filled, text.size() - filled, static_cast<off_t>(filled));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) {
      throw InputError({file_.string(), "", expected_,
                        fmt::format("a file that cannot be read to its end: {}", describe(errno)), ""});
    }
    filled += static_cast<std::size_t>(got);
    if (filled > most) refuse(filled);
    if (got == 0) {
      text.resize(filled);
      return text;
    }
  }
}

std::string faultOfFile(const fs::path& file) {
  struct stat status {};
  return ::stat(file.c_str(), &status) == 0 ? faultOf(status) : describe(errno);
}

}  // namespace facezip
