#include "io/staged_directory.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <stdio.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <system_error>
#include <utility>

#include "facezip/error.hpp"

namespace facezip::io {
namespace fs = std::filesystem;
namespace {

std::string errnoText() { return std::strerror(errno); }

/// "/a/b" for "/a/b/" too, so that the name of the directory is never empty.
fs::path withoutTrailingSlash(fs::path path) {
  path = path.lexically_normal();
  return path.has_filename() ? path : path.parent_path();
}

void requireReplaceable(const fs::path& target, StagedDirectory::Existing existing, const fs::path& marker) {
  std::error_code error;
  const fs::file_status status = fs::status(target, error);
  if (!fs::exists(status)) return;
  if (!fs::is_directory(status)) {
    throw OutputError(target, "a file with that name is in the way", "choose another --output");
  }
  if (existing == StagedDirectory::Existing::kMerge || fs::is_empty(target, error)) return;
  if (!fs::exists(target / marker, error)) {
    throw OutputError(target, fmt::format("the directory is not empty and holds no {}", marker.string()),
                      "choose another --output");
  }
}

/// Swaps two directories in one step where the file system can, so that a reader never finds `target` missing.
bool exchange(const fs::path& a, const fs::path& b) {
  return ::renameat2(AT_FDCWD, a.c_str(), AT_FDCWD, b.c_str(), RENAME_EXCHANGE) == 0;
}

}  // namespace

StagedDirectory::StagedDirectory(fs::path target, Existing existing, fs::path marker)
    : target_(withoutTrailingSlash(fs::absolute(target))), existing_(existing) {
  requireReplaceable(target_, existing, marker);
  createDirectories(target_.parent_path());
  std::string pattern = (target_.parent_path() / ("." + target_.filename().string() + ".partial-XXXXXX")).string();
  if (::mkdtemp(pattern.data()) == nullptr) throw OutputError(target_, errnoText());
  staging_ = pattern;
  // mkdtemp makes the directory private; what is published gets the usual rights.
  fs::permissions(staging_, fs::perms::owner_all | fs::perms::group_read | fs::perms::group_exec |
                                fs::perms::others_read | fs::perms::others_exec);
}

StagedDirectory::~StagedDirectory() {
  std::error_code ignored;
  fs::remove_all(staging_, ignored);
}

void StagedDirectory::clear() {
  for (const fs::directory_entry& entry : fs::directory_iterator(staging_)) {
    std::error_code error;
    fs::remove_all(entry.path(), error);
    if (error) throw OutputError(target_, error.message());
  }
}

void StagedDirectory::commit() {
  if (existing_ == Existing::kMerge) {
    mergeIntoTarget();
  } else {
    replaceTarget();
  }
  committed_ = true;
}

void StagedDirectory::replaceTarget() {
  std::error_code error;
  if (fs::exists(target_, error)) {
    if (exchange(staging_, target_)) return;  // the destructor removes the old directory, now under the staging name
    fs::remove_all(target_, error);
  }
  fs::rename(staging_, target_, error);
  if (error) throw OutputError(target_, error.message());
}

void StagedDirectory::mergeIntoTarget() {
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(staging_)) {
    const fs::path destination = target_ / entry.path().lexically_relative(staging_);
    if (entry.is_directory()) {
      createDirectories(destination);
      continue;
    }
    createDirectories(destination.parent_path());
    std::error_code error;
    fs::rename(entry.path(), destination, error);
    if (error) throw OutputError(destination, error.message());
  }
  createDirectories(target_);
}

void createDirectories(const fs::path& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (error) throw OutputError(path, error.message(), "choose another --output");
}

void writeTextFile(const fs::path& path, const std::string& text) {
  errno = 0;
  std::ofstream file(path, std::ios::binary);
  file << text;
  file.close();
  if (!file) throw OutputError(path, errno != 0 ? errnoText() : "write failed");
}

void writeTextFileAtomically(const fs::path& path, const std::string& text) {
  const fs::path absolute = fs::absolute(path);
  const fs::path partial =
      absolute.parent_path() / fmt::format(".{}.partial-{}", absolute.filename().string(), ::getpid());
  std::error_code error;
  try {
    writeTextFile(partial, text);
    fs::rename(partial, absolute, error);
    if (error) throw OutputError(path, error.message());
  } catch (const OutputError& failure) {
    fs::remove(partial, error);
    throw OutputError(path, failure.what());
  }
}

}  // namespace facezip::io
