// program_cache.hpp - binaries of built programs in files: kernels are compiled once for each device, not once a
// process.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace facezip::device {

/// A folder of binaries. Nothing it does is an error: without it, kernels are compiled again. Processes may share it.
class ProgramCache {
 public:
  /// An empty path is a cache that holds nothing.
  explicit ProgramCache(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// FACEZIP_CACHE_DIR (set but empty: none), else XDG_CACHE_HOME/facezip, else HOME/.cache/facezip, else none.
  static ProgramCache ofUser();

  /// False for a cache that holds nothing.
  bool keeps() const { return !folder_.empty(); }

  /// The binary that was kept under `key`; none when there is none or its file is damaged.
  /// key  all that decides what the binary is: device, driver, options and source, in full
  std::optional<std::vector<unsigned char>> find(std::string_view key) const;

  /// Keeps `binary`: readers see the whole file or none. Where it cannot be written, nothing happens.
  void store(std::string_view key, const std::vector<unsigned char>& binary) const noexcept;

  /// The file that `key` is kept in.
  std::filesystem::path fileOf(std::string_view key) const;

 private:
  std::filesystem::path folder_;
};

}  // namespace facezip::device
