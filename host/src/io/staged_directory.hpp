// staged_directory.hpp - a directory that appears whole or not at all.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace facezip::io {

/// How a directory that the program made is told from a stranger's, which must never be replaced.
struct Footprint {
  std::filesystem::path marker;  ///< a file that it holds, for example "package.json",
  std::string signature;         ///< and text in that file
  /// Files of such a directory that are the program's, or folders with all they hold, as paths from there. None: all
  /// that stands under a name that the new directory has at its top.
  std::function<std::vector<std::filesystem::path>(const std::filesystem::path& directory)> files = {};
};

/// Collects files in a hidden sibling of `target` and moves them into place in commit().
/// Without commit() the destructor removes everything that was written, and `target` is as it was.
/// A link to a directory stands for that directory.
class StagedDirectory {
 public:
  /// commit() replaces an empty directory, or one of the program's own that holds nothing else, with one rename. What
  /// engines lay beside files that stay (x.png.meta, x.png.import) is kept.
  /// Throws OutputError if the parent cannot be written to or `target` must not be replaced.
  StagedDirectory(std::filesystem::path target, Footprint own);
  /// commit() moves the files into any directory one by one, replacing files of the same name.
  explicit StagedDirectory(std::filesystem::path target);
  ~StagedDirectory();
  StagedDirectory(const StagedDirectory&) = delete;
  StagedDirectory& operator=(const StagedDirectory&) = delete;

  /// Where to write; sub-directories are the caller's to make.
  const std::filesystem::path& path() const { return staging_; }

  /// Removes what was written so far. Throws OutputError.
  void clear();

  /// Puts the directory in place. Throws OutputError.
  void commit();

 private:
  void makeStaging();
  bool isOwn(const std::filesystem::path& relative) const;
  void requireNoStrangers() const;
  void keepCompanions() const;
  void replaceTarget();
  void mergeIntoTarget();

  std::filesystem::path target_;
  std::filesystem::path staging_;
  std::optional<Footprint> own_;                  // none where files are merged into the target
  std::vector<std::filesystem::path> own_files_;  // of the target, where own_->files tells them
};

/// Makes `path` and its parents. Throws OutputError.
void createDirectories(const std::filesystem::path& path);

/// Writes `text` to `path`; throws OutputError when any of it does not reach the file (a full disk).
void writeTextFile(const std::filesystem::path& path, const std::string& text);

/// The regular file that writing to `path` replaces, there or not: the one that a link leads to. Empty where something
/// else stands there (a device, a pipe), which is to be written to, never renamed over.
std::filesystem::path fileToReplace(const std::filesystem::path& path);

/// Throws OutputError where `path`, there or not, is `folder` or lies in it; `what` says whose the folder is.
void requireOutside(const std::filesystem::path& path, const std::filesystem::path& folder, const std::string& what);

/// Writes `text` beside `path` and renames it into place, so that a reader sees the whole file or the old one. Devices
/// and pipes are written to.
void writeTextFileAtomically(const std::filesystem::path& path, const std::string& text);

}  // namespace facezip::io
