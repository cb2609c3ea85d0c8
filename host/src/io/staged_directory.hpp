// staged_directory.hpp - a directory that appears whole or not at all.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "io/unfinished.hpp"
#include "io/write_file.hpp"

namespace facezip::io {

/// How a directory that the program made is told from a stranger's, which must never be replaced.
struct Footprint {
  std::filesystem::path marker;  ///< a file that it holds, for example "package.json",
  std::string signature;         ///< and text in that file
  /// Files of such a directory that are the program's, or folders with all they hold, as paths from there. None: all
  /// that stands under a name that the new directory has at its top.
  std::function<std::vector<std::filesystem::path>(const std::filesystem::path& directory)> files = {};
};

/// Collects files in a hidden sibling of `target` and moves them into place in commit(), when the disk has them.
/// Without commit() the destructor removes everything that was written, and `target` is as it was. What killed runs
/// left beside `target` is removed, and noted. A link to a directory stands for that directory.
class StagedDirectory {
 public:
  /// commit() replaces an empty directory, or one of the program's own that holds nothing else, with one rename. What
  /// engines lay beside files that stay (x.png.meta, x.png.import) is kept.
  /// progress  gets notes; may be null
  /// Throws OutputError if the parent cannot be written to or `target` must not be replaced.
  StagedDirectory(std::filesystem::path target, Footprint own, Progress* progress = nullptr);
  /// commit() moves the files into any directory one by one, replacing files of the same name.
  explicit StagedDirectory(std::filesystem::path target, Progress* progress = nullptr);
  ~StagedDirectory();
  StagedDirectory(const StagedDirectory&) = delete;
  StagedDirectory& operator=(const StagedDirectory&) = delete;

  /// Where to write; sub-directories are the caller's to make.
  const std::filesystem::path& path() const { return staging_; }

  /// Removes what was written so far. Throws OutputError.
  void clear();

  /// Puts the directory in place. Throws OutputError, also where another run put one there meanwhile: that one stays.
  void commit();

 private:
  using Identity = std::pair<std::uint64_t, std::uint64_t>;  ///< device and number of a directory

  void lookAtTarget(Progress* progress);
  void makeStaging();
  bool isOwn(const std::filesystem::path& relative) const;
  void requireNoStrangers() const;
  void requireAsFound() const;
  void keepCompanions() const;
  void replaceTarget();
  void moveIn();
  void swapIn();
  void requireRoomForMerge() const;
  void mergeIntoTarget();

  std::filesystem::path target_;
  std::filesystem::path staging_;
  std::optional<WriteLock> lock_;
  std::optional<Identity> found_;                 // what stood at target_ when this began
  std::optional<Footprint> own_;                  // none where files are merged into the target
  std::vector<std::filesystem::path> own_files_;  // of the target, where own_->files tells them
};

}  // namespace facezip::io
