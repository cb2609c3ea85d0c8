#include "io/durable.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "facezip/error.hpp"

namespace facezip::io {
namespace fs = std::filesystem;
namespace {

void sync(const fs::path& path, int flags) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | flags);
  if (descriptor < 0) throw OutputError(path, std::strerror(errno));
  int error = 0;
  do {
    error = ::fsync(descriptor) == 0 ? 0 : errno;
  } while (error == EINTR);
  ::close(descriptor);
  if (error != 0 && error != EINVAL && error != ENOTSUP && error != EROFS) {
    throw OutputError(path, std::strerror(error), "is the disk full?");
  }
}

}  // namespace

void syncFile(const fs::path& file) { sync(file, O_NOFOLLOW); }

void syncFolder(const fs::path& folder) { sync(folder.empty() ? "." : folder, O_DIRECTORY); }

void syncTree(const fs::path& folder) {
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_symlink()) continue;
    if (entry.is_directory()) {
      syncFolder(entry.path());
    } else {
      syncFile(entry.path());
    }
  }
  syncFolder(folder);
}

}  // namespace facezip::io
