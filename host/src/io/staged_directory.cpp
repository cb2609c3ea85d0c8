#include "io/staged_directory.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <stdio.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <system_error>
#include <utility>

#include "facezip/error.hpp"
#include "io/read_file.hpp"

namespace facezip::io {
namespace fs = std::filesystem;
namespace {

std::string errnoText() { return std::strerror(errno); }

fs::path absoluteTarget(const fs::path& target) {
  if (target.empty()) throw InputError({"--output", "", "a name", "an empty one", ""});
  return fs::absolute(target);
}

/// "/a/b" for "/a/b/" too, so that the name of the directory is never empty.
fs::path withoutTrailingSlash(fs::path path) {
  path = path.lexically_normal();
  return path.has_filename() ? path : path.parent_path();
}

/// What an engine writes beside a file or folder that it imports: x.png.meta beside x.png.
bool isCompanion(const fs::path& file) {
  const fs::path extension = file.extension();
  return extension == ".meta" || extension == ".import" || extension == ".uid";
}

/// What Godot makes of a folder's files when it opens it as a project, and makes again.
bool isCache(const fs::path& relative) { return *relative.begin() == ".import" || *relative.begin() == ".godot"; }

/// Calls visit(path from `directory`) for all that is no folder.
template <typename Visit>
void forEachFile(const fs::path& directory, const Visit& visit) {
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(directory)) {
    if (entry.symlink_status().type() != fs::file_type::directory) {
      visit(entry.path().lexically_relative(directory));
    }
  }
}

bool isWithin(const fs::path& inner, const fs::path& outer) {
  return std::mismatch(outer.begin(), outer.end(), inner.begin(), inner.end()).first == outer.end();
}

/// The directory that `target` is, or is a link to.
fs::path directoryOf(const fs::path& target) {
  const fs::path path = withoutTrailingSlash(absoluteTarget(target));
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (fs::exists(status) && !fs::is_directory(status)) {
    throw OutputError(path, "a file with that name is in the way", "choose another --output");
  }
  if (!fs::is_symlink(fs::symlink_status(path, error))) return path;
  if (!fs::exists(status)) throw OutputError(path, "the link leads nowhere", "choose another --output");
  return fs::canonical(path);
}

void requireMarker(const fs::path& target, const Footprint& own) {
  std::error_code error;
  const bool marked = fs::is_regular_file(target / own.marker, error);
  if (marked && readFile(target / own.marker, "a file of the output").find(own.signature) != std::string::npos) return;
  throw OutputError(
      target,
      fmt::format("the directory is not empty and holds no {}{}", own.marker.string(), marked ? " of facezip's" : ""),
      "choose another --output");
}

/// Swaps two directories in one step where the file system can, so that a reader never finds `target` missing.
bool exchange(const fs::path& a, const fs::path& b) {
  return ::renameat2(AT_FDCWD, a.c_str(), AT_FDCWD, b.c_str(), RENAME_EXCHANGE) == 0;
}

}  // namespace

StagedDirectory::StagedDirectory(fs::path target, Footprint own) : target_(directoryOf(target)), own_(std::move(own)) {
  std::error_code error;
  if (fs::exists(target_, error) && !fs::is_empty(target_, error)) {
    requireMarker(target_, *own_);
    if (own_->files) {
      own_files_ = own_->files(target_);
      requireNoStrangers();
    }
  }
  makeStaging();
}

StagedDirectory::StagedDirectory(fs::path target) : target_(directoryOf(target)) { makeStaging(); }

void StagedDirectory::makeStaging() {
  createDirectories(target_.parent_path());
  // Not mkdtemp(), which makes directories private: this one is published.
  for (int attempt = 0; staging_.empty(); ++attempt) {
    const std::string name = fmt::format(".{}.partial-{}-{}", target_.filename().string(), ::getpid(), attempt);
    if (::mkdir((target_.parent_path() / name).c_str(), 0777) == 0) {
      staging_ = target_.parent_path() / name;
    } else if (errno != EEXIST) {
      throw OutputError(target_, errnoText());
    }
  }
}

bool StagedDirectory::isOwn(const fs::path& relative) const {
  if (own_->files) {
    // The folders on the way to a file of ours are ours; so is all that lies in a folder that is named itself.
    return std::any_of(own_files_.begin(), own_files_.end(),
                       [&](const fs::path& own) { return isWithin(own, relative) || isWithin(relative, own); });
  }
  return fs::exists(fs::symlink_status(staging_ / *relative.begin()));
}

/// Throws OutputError when a file of the target is neither the program's nor a companion of one.
void StagedDirectory::requireNoStrangers() const {
  forEachFile(target_, [&](const fs::path& file) {
    if (isCache(file) || isOwn(file) || (isCompanion(file) && isOwn(fs::path(file).replace_extension()))) return;
    throw OutputError(target_, fmt::format("it holds \"{}\", which this command did not write", file.string()),
                      "move that elsewhere, or choose another --output");
  });
}

/// Copies the companions of what stays from the target.
void StagedDirectory::keepCompanions() const {
  forEachFile(target_, [&](const fs::path& file) {
    if (!isCompanion(file) || !fs::exists(staging_ / fs::path(file).replace_extension())) return;
    fs::copy_file(target_ / file, staging_ / file, fs::copy_options::skip_existing);
  });
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
  try {
    if (own_) {
      replaceTarget();
    } else {
      mergeIntoTarget();
    }
  } catch (const fs::filesystem_error& error) {
    throw OutputError(target_, error.code().message());
  }
}

void StagedDirectory::replaceTarget() {
  std::error_code error;
  if (fs::exists(target_, error)) {
    requireNoStrangers();
    keepCompanions();
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

fs::path fileToReplace(const fs::path& path) {
  std::error_code error;
  const fs::path absolute = absoluteTarget(path);
  const fs::file_status status = fs::status(absolute, error);
  if (fs::exists(status) && !fs::is_regular_file(status)) return {};
  return fs::is_symlink(fs::symlink_status(absolute, error)) ? fs::weakly_canonical(absolute) : absolute;
}

void requireOutside(const fs::path& path, const fs::path& folder, const std::string& what) {
  const fs::path inner = withoutTrailingSlash(fs::weakly_canonical(absoluteTarget(path)));
  if (!isWithin(inner, withoutTrailingSlash(fs::weakly_canonical(folder)))) return;
  throw OutputError(path, fmt::format("it lies in {}, {}", folder.string(), what), "choose another --output");
}

void writeTextFileAtomically(const fs::path& path, const std::string& text) {
  const fs::path target = fileToReplace(path);
  if (target.empty()) return writeTextFile(path, text);  // /dev/stdout, a pipe; a directory says so itself
  const fs::path partial = target.parent_path() / fmt::format(".{}.partial-{}", target.filename().string(), ::getpid());
  std::error_code error;
  try {
    writeTextFile(partial, text);
    fs::rename(partial, target, error);
    if (error) throw OutputError(path, error.message());
  } catch (const OutputError& failure) {
    fs::remove(partial, error);
    throw OutputError(path, failure.what());
  }
}

}  // namespace facezip::io
