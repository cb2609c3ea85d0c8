// protected_paths.hpp - what a command reads, which nothing that it writes may replace.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "facezip/error.hpp"

namespace facezip {

/// Files and folders that outputs must not touch: the inputs of a command, and its other outputs. Known by their paths,
/// links resolved, and by what they are on the disk (device and number), so that other names of the same file, other
/// mounts of the same folder and names in another case are recognised.
class ProtectedPaths {
 public:
  /// path  a file, or a folder with all that lies in it, links to other folders included; need not be there; an empty
  ///       one is nothing
  /// what  for messages: "the capture"
  ProtectedPaths& add(const std::filesystem::path& path, const std::string& what);
  /// The same where a folder would be a mistake, which is told when the file is read.
  ProtectedPaths& addFile(const std::filesystem::path& file, const std::string& what);
  ProtectedPaths& add(const ProtectedPaths& others);

  /// Throws OutputError where `output`, a file or a folder that files are added to, there or not, is one of these or
  /// lies in one. Devices and pipes pass: they are written to, not replaced. An empty name passes.
  /// option  that names another place, for the message
  void requireApart(const std::filesystem::path& output, const std::string& option = "--output") const;

  /// The same for a folder that is replaced: none of these may lie in it, either.
  void requireApartFromFolder(const std::filesystem::path& output, const std::string& option = "--output") const;

 private:
  using Identity = std::pair<std::uint64_t, std::uint64_t>;
  struct Entry {
    std::filesystem::path named;     ///< for messages
    std::filesystem::path resolved;  ///< absolute, without links
    std::vector<Identity> way;       ///< of itself and the folders above, the nearest first, as far as they are there
    bool there = false;              ///< then way.front() is its own
    bool folder = false;
    std::string what;
  };
  static Entry entryOf(const std::filesystem::path& path, const std::string& what);
  static bool liesIn(const Entry& inner, const Entry& outer);
  static bool holdsFile(const Entry& folder, const Identity& file);

  std::vector<Entry> entries_;
};

}  // namespace facezip
