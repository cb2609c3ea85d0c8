// unfinished.hpp - the hidden names under which outputs are written before they appear, and who is writing them.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "facezip/progress.hpp"

namespace facezip::io {

/// ".NAME" of a target, cut where the name of an unfinished output would be longer than the file system takes: the
/// start of all its hidden names. Two targets of one folder never have the same.
std::string hiddenStem(const std::filesystem::path& target);

/// A file or folder that this process is writing: a lock that the kernel takes back however the process ends.
class WriteLock {
 public:
  ~WriteLock();
  WriteLock(WriteLock&& other) noexcept;
  WriteLock& operator=(WriteLock&& other) noexcept;

  enum class Of { kNewFile, kFolder };
  /// kNewFile  an empty file is made where there is none
  /// error     of the system's, where it cannot be opened; else 0
  /// None where another process holds it, where it went away or was replaced meanwhile, or where it cannot be opened.
  /// A file system without locks gives a lock that nobody else sees: see isKnown().
  static std::optional<WriteLock> take(const std::filesystem::path& path, Of kind, int& error);

  /// False where the file system cannot tell whether others are writing.
  bool isKnown() const { return known_; }

 private:
  WriteLock(int descriptor, bool known) : descriptor_(descriptor), known_(known) {}

  int descriptor_;
  bool known_;
};

/// An empty folder beside `target` to write in, locked. After removeLeftovers().
struct UnfinishedFolder {
  std::filesystem::path path;
  WriteLock lock;
};
enum class Access { kEverybody, kOwner };
/// Throws OutputError where none can be made.
UnfinishedFolder makeUnfinishedFolder(const std::filesystem::path& target, Access access = Access::kEverybody);

/// Removes the folders that runs left beside `target` when they were killed, and brings back what such a run moved out
/// of the way; says so. Folders of runs that are at work stay.
void removeLeftovers(const std::filesystem::path& target, Progress* progress);

/// Where replaced outputs wait while another takes their place, on file systems that cannot swap two names.
std::filesystem::path replacedName(const std::filesystem::path& target);

}  // namespace facezip::io
