// staged_directory.hpp - a directory that appears whole or not at all.
#pragma once

#include <filesystem>

namespace facezip::io {

/// Collects files in a hidden sibling of `target` and moves them into place with one rename in commit().
/// Without commit() the destructor removes everything that was written, and `target` is as it was.
class StagedDirectory {
 public:
  /// What may stand at `target` already.
  enum class Existing {
    kReplaceMarked,  ///< an empty directory, or one that holds `marker`: it is replaced whole by commit()
    kMerge,          ///< any directory: commit() moves the files in one by one, replacing files of the same name
  };

  /// Creates the staging directory beside `target`. `marker` is the file that tells a directory of ours from a
  /// stranger's, for example "package.json". Throws OutputError if the parent cannot be written to or `target` is
  /// something that must not be replaced.
  StagedDirectory(std::filesystem::path target, Existing existing, std::filesystem::path marker = {});
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
  void replaceTarget();
  void mergeIntoTarget();

  std::filesystem::path target_;
  std::filesystem::path staging_;
  Existing existing_;
  bool committed_ = false;
};

/// Makes `path` and its parents. Throws OutputError.
void createDirectories(const std::filesystem::path& path);

/// Writes `text` to `path`; throws OutputError when any of it does not reach the file (a full disk).
void writeTextFile(const std::filesystem::path& path, const std::string& text);

/// Writes `text` beside `path` and renames it into place, so that a reader sees the whole file or the old one.
void writeTextFileAtomically(const std::filesystem::path& path, const std::string& text);

}  // namespace facezip::io
