// scratch_file.hpp - room on disk for decoded samples between passes.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>

namespace facezip::image {

/// A file without a name that holds decoded samples between passes: decoding costs far more than reading back, and what
/// lies here is the kernel's to keep in memory or not. Gone when the process ends, however it ends.
class ScratchFile {
 public:
  /// directory  where to make it; must be writable. Throws OutputError.
  explicit ScratchFile(const std::filesystem::path& directory);
  ~ScratchFile();
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;

  /// Throw OutputError when the disk is full or fails.
  void write(std::size_t offset, std::span<const std::byte> bytes);
  void read(std::size_t offset, std::span<std::byte> bytes) const;

  /// Bytes free for a scratch file in `directory`.
  static std::size_t freeBytes(const std::filesystem::path& directory);

 private:
  std::filesystem::path directory_;
  int descriptor_ = -1;
};

}  // namespace facezip::image
