#include "io/unfinished.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "facezip/error.hpp"

namespace facezip::io {
namespace fs = std::filesystem;
namespace {

/// FNV-1a.
std::uint64_t hashOf(std::string_view bytes) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (const char b : bytes) hash = (hash ^ static_cast<unsigned char>(b)) * 0x100000001b3u;
  return hash;
}

/// Is what is open still called `path`? Other names of a file, and pipes, are a stranger's trap.
bool isOurs(int descriptor, const fs::path& path) {
  struct stat open {};
  struct stat named {};
  if (::fstat(descriptor, &open) != 0 || ::lstat(path.c_str(), &named) != 0) return false;
  if (open.st_dev != named.st_dev || open.st_ino != named.st_ino) return false;
  return S_ISDIR(open.st_mode) || (S_ISREG(open.st_mode) && open.st_nlink == 1);
}

/// Is `name` what makeUnfinishedFolder() calls a folder: `start`, a process, a dash, a number?
bool isUnfinishedName(std::string_view name, const std::string& start) {
  if (!name.starts_with(start)) return false;
  name.remove_prefix(start.size());
  const std::size_t dash = name.find('-');
  const auto number = [](std::string_view text) {
    return !text.empty() && text.find_first_not_of("0123456789") == std::string_view::npos;
  };
  return dash != std::string_view::npos && number(name.substr(0, dash)) && number(name.substr(dash + 1));
}

std::vector<fs::path> unfinishedFolders(const fs::path& target) {
  const std::string start = hiddenStem(target) + ".partial-";
  std::vector<fs::path> found;
  std::error_code error;
  for (fs::directory_iterator entry(target.parent_path(), error); !error && entry != fs::directory_iterator();
       entry.increment(error)) {
    std::error_code ignored;
    const bool folder = entry->symlink_status(ignored).type() == fs::file_type::directory;
    if (folder && isUnfinishedName(entry->path().filename().string(), start)) found.push_back(entry->path());
  }
  return found;
}

void note(Progress* progress, const std::string& text) {
  if (progress != nullptr) progress->note(text);
}

/// A run was killed between moving the old output away and moving the new one in.
void bringBackReplaced(const fs::path& target, Progress* progress) {
  const fs::path replaced = replacedName(target);
  std::error_code error;
  if (fs::symlink_status(replaced, error).type() != fs::file_type::directory) return;
  int ignored = 0;
  const auto lock = WriteLock::take(replaced, WriteLock::Of::kFolder, ignored);
  if (!lock || !lock->isKnown()) return;  // another run is about to go on
  if (fs::exists(fs::symlink_status(target, error))) {
    fs::remove_all(replaced, error);
  } else {
    fs::rename(replaced, target, error);
    if (!error)
      note(progress, fmt::format("{}: brought back: a run that was replacing it was killed", target.string()));
  }
}

}  // namespace

std::string hiddenStem(const fs::path& target) {
  // ".partial-" and two numbers follow, or a number and an extension.
  constexpr std::size_t kKept = 60;
  const long limit = ::pathconf(target.parent_path().c_str(), _PC_NAME_MAX);
  const std::size_t most = (limit > 0 ? static_cast<std::size_t>(limit) : 255) - kKept;
  const std::string name = target.filename().string();
  if (name.size() < most) return "." + name;
  const std::string hash = fmt::format("~{:016x}", hashOf(name));
  std::size_t length = most - hash.size() - 1;
  while (length > 0 && (static_cast<unsigned char>(name[length]) & 0xc0u) == 0x80u) --length;  // not amid a character
  return "." + name.substr(0, length) + hash;
}

WriteLock::~WriteLock() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

WriteLock::WriteLock(WriteLock&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)), known_(other.known_) {}

WriteLock& WriteLock::operator=(WriteLock&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  std::swap(known_, other.known_);
  return *this;
}

std::optional<WriteLock> WriteLock::take(const fs::path& path, Of kind, int& error) {
  error = 0;
  const int flags = kind == Of::kNewFile ? O_RDWR | O_CREAT | O_NONBLOCK : O_RDONLY | O_DIRECTORY;
  const int descriptor = ::open(path.c_str(), flags | O_NOFOLLOW | O_CLOEXEC, 0666);
  if (descriptor < 0) {
    error = errno;
    return std::nullopt;
  }
  int refusal = 0;
  do {
    refusal = ::flock(descriptor, LOCK_EX | LOCK_NB) == 0 ? 0 : errno;
  } while (refusal == EINTR);
  WriteLock lock(descriptor, refusal == 0);
  // Who held it before may have put it in place, or removed it: then it is no longer what is called so.
  if (refusal == EWOULDBLOCK || !isOurs(descriptor, path)) return std::nullopt;
  return lock;
}

UnfinishedFolder makeUnfinishedFolder(const fs::path& target, Access access) {
  const mode_t mode = access == Access::kOwner ? 0700 : 0777;  // as the user's mask allows
  for (int attempt = 0;; ++attempt) {
    const fs::path path =
        target.parent_path() / fmt::format("{}.partial-{}-{}", hiddenStem(target), ::getpid(), attempt);
    int error = ::mkdir(path.c_str(), mode) == 0 ? 0 : errno;
    if (error == EEXIST) continue;
    if (error != 0) throw OutputError(target, std::strerror(error));
    // Another run may take a folder that is not locked yet for a leftover, and remove it.
    if (auto lock = WriteLock::take(path, WriteLock::Of::kFolder, error)) return {path, std::move(*lock)};
    if (error != 0 && error != ENOENT) throw OutputError(target, std::strerror(error));
  }
}

void removeLeftovers(const fs::path& target, Progress* progress) {
  bringBackReplaced(target, progress);
  for (const fs::path& folder : unfinishedFolders(target)) {
    int ignored = 0;
    const auto lock = WriteLock::take(folder, WriteLock::Of::kFolder, ignored);
    if (!lock) continue;
    if (!lock->isKnown()) {
      note(progress,
           fmt::format("{} may be left from a run that was killed; this file system cannot tell", folder.string()));
      continue;
    }
    std::error_code error;
    fs::remove_all(folder, error);
    if (!error) note(progress, fmt::format("removed {}, left from a run that was killed", folder.string()));
  }
}

fs::path replacedName(const fs::path& target) { return target.parent_path() / (hiddenStem(target) + ".replaced"); }

}  // namespace facezip::io
