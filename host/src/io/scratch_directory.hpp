// scratch_directory.hpp - room for files that nobody keeps.
#pragma once

#include <filesystem>
#include <optional>

#include "io/unfinished.hpp"

namespace facezip::io {

/// A folder of this process's own in the directory for temporary files (TMPDIR, else /tmp), which nobody else may read.
/// Gone with the object; what killed runs left of theirs is removed.
class ScratchDirectory {
 public:
  /// Throws OutputError where there is no such directory, or none that can be written to.
  ScratchDirectory();
  ~ScratchDirectory();
  ScratchDirectory(const ScratchDirectory&) = delete;
  ScratchDirectory& operator=(const ScratchDirectory&) = delete;

  const std::filesystem::path& path() const { return folder_->path; }

 private:
  std::optional<UnfinishedFolder> folder_;
};

}  // namespace facezip::io
