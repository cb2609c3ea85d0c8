// fuzz_input.hpp - what the entries of libFuzzer share.
#pragma once

#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <string_view>

#include "facezip/error.hpp"
#include "facezip/input_file.hpp"

namespace facezip::fuzz {

/// The input as text.
inline std::string textOf(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

/// Calls `read`, which may refuse its input by an InputError in one line of bounded length. Whatever else it throws,
/// or does, is a finding.
template <typename Read>
void refuseOrRead(const Read& read) {
  constexpr std::size_t kLongestMessage = 20000;
  try {
    read();
  } catch (const InputError& error) {
    if (std::string_view(error.what()).size() > kLongestMessage) std::abort();
  }
}

/// A file in memory that holds the input, for readers that take paths.
class MemoryFile {
 public:
  MemoryFile(const std::uint8_t* data, std::size_t size) : descriptor_(::memfd_create("input", MFD_CLOEXEC)) {
    if (descriptor_ < 0 || ::write(descriptor_, data, size) != static_cast<ssize_t>(size)) std::abort();
  }
  ~MemoryFile() { ::close(descriptor_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  std::filesystem::path path() const { return "/proc/self/fd/" + std::to_string(descriptor_); }
  InputFile open() const { return InputFile(path(), "a file"); }

 private:
  int descriptor_;
};

}  // namespace facezip::fuzz
