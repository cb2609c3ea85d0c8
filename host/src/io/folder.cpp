#include "io/folder.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cassert>
#include <cerrno>
#include <system_error>
#include <utility>

#include "facezip/error.hpp"

namespace facezip::io {
namespace fs = std::filesystem;
namespace {

constexpr const char* kReplaced = "something else took its place while it was read: do it again";

/// A descriptor of a folder on the way to a file.
class Step {
 public:
  explicit Step(int descriptor) : descriptor_(descriptor) {}
  ~Step() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  Step(const Step&) = delete;
  Step& operator=(const Step&) = delete;
  void reset(int descriptor) {
    if (descriptor_ >= 0) ::close(descriptor_);
    descriptor_ = descriptor;
  }
  int get() const { return descriptor_; }

 private:
  int descriptor_;
};

/// Opens one part of a path, links refused: errno is ELOOP for them, whatever the system says of them.
int openPart(int folder, const std::string& part, int flags) {
  const int descriptor = ::openat(folder, part.c_str(), flags | O_NOFOLLOW | O_CLOEXEC);
  if (descriptor >= 0) return descriptor;
  const int error = errno;
  struct stat status {};
  const bool is_link = ::fstatat(folder, part.c_str(), &status, AT_SYMLINK_NOFOLLOW) == 0 && S_ISLNK(status.st_mode);
  errno = is_link ? ELOOP : error;
  return -1;
}

}  // namespace

Folder::Folder(fs::path path) : path_(std::move(path)) {
  descriptor_ = ::open(path_.empty() ? "." : path_.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC);
  if (descriptor_ < 0) throw std::system_error(errno, std::generic_category(), path_.string());
}

Folder::~Folder() {
  for (const auto& [name, seen] : seen_) {
    if (seen.kept >= 0) ::close(seen.kept);
  }
  ::close(descriptor_);
}

Folder::Identity Folder::identityOf(int descriptor) {
  struct stat status {};
  if (::fstat(descriptor, &status) != 0) throw std::system_error(errno, std::generic_category(), "fstat");
  return {status.st_dev, status.st_ino, status.st_size, status.st_mtim.tv_sec, status.st_mtim.tv_nsec};
}

int Folder::openAt(const std::string& name) const {
  assert(!name.empty() && name.front() != '/' && name.find("..") == std::string::npos);
  Step step(-1);
  int folder = descriptor_;
  std::size_t begin = 0;
  for (std::size_t end = name.find('/'); end != std::string::npos; end = name.find('/', begin)) {
    step.reset(openPart(folder, name.substr(begin, end - begin), O_PATH | O_DIRECTORY));
    if (step.get() < 0) return -1;
    folder = step.get();
    begin = end + 1;
  }
  return openPart(folder, name.substr(begin), O_RDONLY | O_NONBLOCK | O_NOCTTY);
}

InputFile Folder::openFirst(const std::string& name, const std::string& expected, const std::string& cure) const {
  const int descriptor = openAt(name);
  const fs::path file = path_ / name;
  if (descriptor < 0 && errno == ELOOP) {
    throw InputError({file.string(), "", expected, "a link, or something behind one",
                      "links of packages are not followed: put the file itself there"});
  }
  if (descriptor < 0 && errno == ENOENT && wasReplaced()) {
    throw InputError({file.string(), "", expected, "no such file any more", kReplaced});
  }
  return InputFile(descriptor, file, expected, cure);
}

InputFile Folder::open(const std::string& name, const std::string& expected, const std::string& cure) const {
  constexpr std::size_t kMostKept = 256;  // a process may hold 1024 by default
  const std::scoped_lock lock(mutex_);
  const auto before = seen_.find(name);
  const bool kept = before != seen_.end() && before->second.kept >= 0;
  InputFile opened = kept ? InputFile(::fcntl(before->second.kept, F_DUPFD_CLOEXEC, 0), path_ / name, expected, cure)
                          : openFirst(name, expected, cure);
  const Identity identity = identityOf(opened.descriptor());
  if (before == seen_.end()) {
    const bool room = seen_.size() < kMostKept;
    seen_.emplace(name, Seen{identity, room ? ::fcntl(opened.descriptor(), F_DUPFD_CLOEXEC, 0) : -1});
  } else if (before->second.identity != identity) {
    throw InputError({(path_ / name).string(), "", "the file that was there before", "another", kReplaced});
  }
  return opened;
}

bool Folder::has(const std::string& name) const {
  struct stat status {};
  return ::fstatat(descriptor_, name.c_str(), &status, AT_SYMLINK_NOFOLLOW) == 0 && !S_ISDIR(status.st_mode);
}

bool Folder::wasReplaced() const {
  struct stat now {
  }, own{};
  if (::fstat(descriptor_, &own) != 0 || ::stat(path_.empty() ? "." : path_.c_str(), &now) != 0) return true;
  return now.st_dev != own.st_dev || now.st_ino != own.st_ino;
}

}  // namespace facezip::io
