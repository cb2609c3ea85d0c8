#include "io/write_file.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <system_error>

#include "facezip/error.hpp"
#include "io/durable.hpp"

namespace facezip::io {
namespace fs = std::filesystem;

void createDirectories(const fs::path& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (error) throw OutputError(path, error.message(), "choose another --output");
}

fs::path fileToReplace(const fs::path& path) {
  if (path.empty()) throw InputError({"--output", "", "a name", "an empty one", ""});
  std::error_code error;
  const fs::path absolute = fs::absolute(path);
  const fs::file_status status = fs::status(absolute, error);
  if (fs::exists(status) && !fs::is_regular_file(status)) return {};
  return fs::is_symlink(fs::symlink_status(absolute, error)) ? fs::weakly_canonical(absolute) : absolute;
}

void writeTextFile(const fs::path& path, const std::string& text) {
  errno = 0;
  std::ofstream file(path, std::ios::binary);
  file << text;
  file.close();
  if (!file) throw OutputError(path, errno != 0 ? std::strerror(errno) : "write failed");
}

void writeTextFileAtomically(const fs::path& path, const std::string& text, Progress* progress) {
  if (fileToReplace(path).empty()) return writeTextFile(path, text);  // /dev/stdout, a pipe; a folder says so itself
  StagedFile staged(path, progress);
  try {
    writeTextFile(staged.path(), text);
  } catch (const OutputError& error) {
    throw error.of(path);
  }
  staged.commit();
}

StagedFile::StagedFile(const fs::path& file, Progress* progress, Durability durability)
    : file_(file), target_(fileToReplace(file)), durability_(durability) {
  if (target_.empty()) throw OutputError(file, "something that is no file is in the way", "choose another --output");
  // A number that is free, or was a killed run's: not the process's own, so that leftovers are found without looking
  // through folders of thousands of frames.
  constexpr std::size_t kLongestExtension = 16;
  const std::string own = target_.extension().string();
  const std::string extension = own.size() <= kLongestExtension ? own : "";
  for (int number = 0; !lock_; ++number) {
    partial_ = target_.parent_path() / fmt::format("{}.partial-{}{}", hiddenStem(target_), number, extension);
    std::error_code ignored;
    const bool left = fs::exists(fs::symlink_status(partial_, ignored));
    int error = 0;
    lock_ = WriteLock::take(partial_, WriteLock::Of::kNewFile, error);
    if (error != 0 && !left) throw OutputError(file, std::strerror(error));
    if (lock_ && left && progress != nullptr) {
      progress->note(fmt::format("removed {}, left from a run that was killed", partial_.string()));
    }
  }
}

StagedFile::~StagedFile() {
  std::error_code ignored;
  if (lock_) fs::remove(partial_, ignored);
}

void StagedFile::commit() {
  std::error_code error;
  try {
    if (durability_ == Durability::kDisk) syncFile(partial_);
    fs::rename(partial_, target_, error);
    if (error) throw OutputError(file_, error.message());
    lock_.reset();
    if (durability_ == Durability::kDisk) syncFolder(target_.parent_path());
  } catch (const OutputError& failure) {
    throw failure.of(file_);
  }
}

}  // namespace facezip::io
