// folder.hpp - a folder of a stranger's, and the files in it.
#pragma once

#include <sys/stat.h>

#include <cstdint>
#include <ctime>
#include <filesystem>
#include <map>
#include <mutex>
#include <string>

#include "facezip/input_file.hpp"

namespace facezip::io {

/// A folder that is open. Its files are found from there, not by its path: whatever folder is renamed to that path
/// later, what is read belongs together. Files that were opened once are kept open (a few hundred of them), so that
/// they are there to the end. No link below the folder is followed, since it might lead out of it.
class Folder {
 public:
  /// Throws std::system_error: no such folder, one that may not be entered.
  explicit Folder(std::filesystem::path path);
  ~Folder();
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  /// Opens a file in it; several threads may do so at once.
  /// name      with `/` between folders; neither absolute nor with ".."
  /// expected  what the file should be, for messages: "an image"
  /// Throws InputError: no such file, no regular one, a link, one that was written to since it was opened first.
  InputFile open(const std::string& name, const std::string& expected, const std::string& cure = "") const;

  /// Whether something stands there that is not a folder.
  bool has(const std::string& name) const;

  /// Whether another folder, or none, stands at the path by now: files of this one that were not opened yet may be
  /// gone.
  bool wasReplaced() const;

  const std::filesystem::path& path() const { return path_; }

 private:
  /// What tells one file, as it is now, from another.
  struct Identity {
    dev_t device;
    ino_t file;
    off_t bytes;
    std::int64_t seconds;
    std::int64_t nanoseconds;
    bool operator==(const Identity&) const = default;
  };
  struct Seen {
    Identity identity;
    int kept = -1;  ///< a descriptor, if there was room for it
  };
  static Identity identityOf(int descriptor);
  int openAt(const std::string& name) const;
  InputFile openFirst(const std::string& name, const std::string& expected, const std::string& cure) const;

  std::filesystem::path path_;
  int descriptor_ = -1;
  mutable std::mutex mutex_;
  mutable std::map<std::string, Seen> seen_;  ///< what was opened, under mutex_
};

}  // namespace facezip::io
