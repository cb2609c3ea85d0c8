// input_file.hpp - the files that facezip reads: regular ones, and nothing else.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>

namespace facezip {

/// A regular file, open for reading. Links are followed; the kind is asked of the file that is open, so that nothing
/// can take its place in between. A pipe would be waited for, and a device may never end.
class InputFile {
 public:
  /// expected  what the file should be, for messages: "an OBJ file"
  /// cure      what to do where it is not there
  /// Throws InputError: no such file, one that may not be read, something that is no file.
  explicit InputFile(const std::filesystem::path& file, const std::string& expected, const std::string& cure = "");
  /// The same of a file that was opened for reading, without waiting (O_NONBLOCK).
  /// descriptor  this object's own from now on; negative where opening failed, and errno says why
  /// file        for messages
  InputFile(int descriptor, const std::filesystem::path& file, const std::string& expected,
            const std::string& cure = "");
  ~InputFile();
  InputFile(InputFile&& other) noexcept;
  InputFile& operator=(InputFile&& other) noexcept;

  /// Open at its first byte; this object's own, and closed with it.
  int descriptor() const { return descriptor_; }
  /// Bytes that the file had when it was opened.
  std::uintmax_t size() const { return size_; }

  /// What stands in the file from its first byte to its last. Throws InputError where that is more than `most` bytes,
  /// or cannot be read.
  std::string read(std::uintmax_t most = std::numeric_limits<std::uintmax_t>::max()) const;

 private:
  std::filesystem::path file_;
  std::string expected_;
  int descriptor_ = -1;
  std::uintmax_t size_ = 0;
};

/// Whether something stands at `file`, and, if so, whether it is a regular file or leads to one. Empty for a regular
/// file; else what it is instead, for messages: "no such file", "a folder", "a pipe", "a device".
std::string faultOfFile(const std::filesystem::path& file);

}  // namespace facezip
