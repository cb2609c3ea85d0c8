// write_file.hpp - single files, whole or not at all.
#pragma once

#include <filesystem>
#include <string>

#include "facezip/progress.hpp"
#include "io/unfinished.hpp"

namespace facezip::io {

/// Makes `path` and its parents. Throws OutputError.
void createDirectories(const std::filesystem::path& path);

/// The regular file that writing to `path` replaces, there or not: the one that a link leads to. Empty where something
/// else stands there (a device, a pipe), which is to be written to, never renamed over.
std::filesystem::path fileToReplace(const std::filesystem::path& path);

/// Writes `text` to `path`; throws OutputError when any of it does not reach the file (a full disk).
void writeTextFile(const std::filesystem::path& path, const std::string& text);

/// Writes `text` beside `path` and puts it in place, so that a reader sees the whole file or the old one. Devices and
/// pipes are written to. progress  may be null; notes as StagedFile does. Throws OutputError.
void writeTextFileAtomically(const std::filesystem::path& path, const std::string& text, Progress* progress = nullptr);

enum class Durability {
  kDisk,   ///< a power cut leaves the old file or the new one
  kKernel  ///< enough for what can be made again, and is checked when it is read
};

/// A file that is written under a hidden name beside `file` and put in place by commit(). Without commit() the
/// destructor removes it. A link stands for the file that it leads to.
class StagedFile {
 public:
  /// The folder of `file` must be there. Notes a file that a run left when it was killed, and takes its name.
  /// progress  may be null
  /// Throws OutputError: a folder that cannot be written to, something that is no file under the name.
  explicit StagedFile(const std::filesystem::path& file, Progress* progress = nullptr,
                      Durability durability = Durability::kDisk);
  ~StagedFile();
  StagedFile(const StagedFile&) = delete;
  StagedFile& operator=(const StagedFile&) = delete;

  /// An empty file to write, of the extension of the target.
  const std::filesystem::path& path() const { return partial_; }

  /// Puts the file in place, where it is to be closed by whoever wrote it. Throws OutputError.
  void commit();

 private:
  std::filesystem::path file_;    ///< as it was named
  std::filesystem::path target_;  ///< what it stands for
  std::filesystem::path partial_;
  std::optional<WriteLock> lock_;
  Durability durability_;
};

}  // namespace facezip::io
