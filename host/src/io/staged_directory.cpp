#include "io/staged_directory.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <stdio.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <system_error>
#include <utility>

#include "facezip/error.hpp"
#include "io/durable.hpp"
#include "io/read_file.hpp"

namespace facezip::io {
namespace fs = std::filesystem;
namespace {

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

/// Renames a directory in one step, so that a reader never finds `to` missing. Returns the system's error, 0 for none.
/// flags  RENAME_EXCHANGE: each gets the other's name; RENAME_NOREPLACE: nothing may stand at `to`
int renameInOneStep(const fs::path& from, const fs::path& to, unsigned flags) {
  return ::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), flags) == 0 ? 0 : errno;
}

/// Does this file system, or kernel, not know the flags?
bool isUnsupported(int error) { return error == EINVAL || error == ENOSYS || error == ENOTSUP; }

std::optional<std::pair<std::uint64_t, std::uint64_t>> identityOf(const fs::path& directory) {
  struct stat status {};
  if (::stat(directory.c_str(), &status) != 0) return std::nullopt;
  return std::pair(std::uint64_t{status.st_dev}, std::uint64_t{status.st_ino});
}

OutputError replacedMeanwhile(const fs::path& target) {
  return {target, "another run put its output there while this one was at work; that one stays",
          "run this again to replace it, or choose another --output"};
}

}  // namespace

StagedDirectory::StagedDirectory(fs::path target, Footprint own, Progress* progress)
    : target_(directoryOf(target)), own_(std::move(own)) {
  lookAtTarget(progress);
  std::error_code error;
  if (found_ && !fs::is_empty(target_, error)) {
    requireMarker(target_, *own_);
    if (own_->files) {
      own_files_ = own_->files(target_);
      requireNoStrangers();
    }
  }
  makeStaging();
}

StagedDirectory::StagedDirectory(fs::path target, Progress* progress) : target_(directoryOf(target)) {
  lookAtTarget(progress);
  makeStaging();
}

void StagedDirectory::lookAtTarget(Progress* progress) {
  createDirectories(target_.parent_path());
  removeLeftovers(target_, progress);
  found_ = identityOf(target_);
}

void StagedDirectory::makeStaging() {
  UnfinishedFolder folder = makeUnfinishedFolder(target_);
  staging_ = std::move(folder.path);
  lock_ = std::move(folder.lock);
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
    syncFile(staging_ / file);
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
    syncTree(staging_);
    if (own_) {
      replaceTarget();
    } else {
      mergeIntoTarget();
    }
    syncFolder(target_.parent_path());
  } catch (const fs::filesystem_error& error) {
    throw OutputError(target_, error.code().message());
  }
}

void StagedDirectory::requireAsFound() const {
  if (identityOf(target_) != found_) throw replacedMeanwhile(target_);
}

void StagedDirectory::replaceTarget() {
  requireAsFound();
  if (!found_) return moveIn();
  requireNoStrangers();
  keepCompanions();
  swapIn();
}

/// Where nothing stood.
void StagedDirectory::moveIn() {
  int error = renameInOneStep(staging_, target_, RENAME_NOREPLACE);
  if (isUnsupported(error)) error = renameInOneStep(staging_, target_, 0);
  if (error == EEXIST || error == ENOTEMPTY) throw replacedMeanwhile(target_);
  if (error != 0) throw OutputError(target_, std::strerror(error));
}

/// Where a directory of ours stood, or an empty one.
void StagedDirectory::swapIn() {
  const int error = renameInOneStep(staging_, target_, RENAME_EXCHANGE);
  if (error == 0) {
    // The destructor removes the old directory, now under the staging name.
    if (identityOf(staging_) == found_) return;
    renameInOneStep(staging_, target_, RENAME_EXCHANGE);  // another run was faster by a hair
    throw replacedMeanwhile(target_);
  }
  if (!isUnsupported(error)) throw OutputError(target_, std::strerror(error));
  // A run that is killed between these steps leaves the old directory for the next run to bring back.
  int ignored = 0;
  const auto lock = WriteLock::take(target_, WriteLock::Of::kFolder, ignored);
  const fs::path old = replacedName(target_);
  fs::remove_all(old);
  fs::rename(target_, old);
  fs::rename(staging_, target_);
  fs::remove_all(old);
}

/// Before any file is moved.
void StagedDirectory::requireRoomForMerge() const {
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(staging_)) {
    const fs::path destination = target_ / entry.path().lexically_relative(staging_);
    std::error_code error;
    const fs::file_status there =
        entry.is_directory() ? fs::status(destination, error) : fs::symlink_status(destination, error);
    if (!fs::exists(there)) continue;
    if (entry.is_directory() && !fs::is_directory(there)) {
      throw OutputError(destination, "something that is no folder is in the way", "choose another --output");
    }
    if (!entry.is_directory() && fs::is_directory(there)) {
      throw OutputError(destination, "a folder is in the way", "choose another --output");
    }
  }
}

void StagedDirectory::mergeIntoTarget() {
  requireRoomForMerge();
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
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(staging_)) {
    if (entry.is_directory()) syncFolder(target_ / entry.path().lexically_relative(staging_));
  }
  syncFolder(target_);
}

}  // namespace facezip::io
