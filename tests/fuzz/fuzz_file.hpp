// fuzz_file.hpp - what a fuzzer made, as the file that a reader wants.
#pragma once

#include <fcntl.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

namespace facezip::fuzz {

/// A folder of this process alone, in memory where the machine has such a place; removed when the process ends.
inline const std::filesystem::path& folder() {
  static const struct Folder {
    Folder() {
      std::error_code ignored;
      const bool memory = std::filesystem::is_directory("/dev/shm", ignored);
      std::string pattern = std::string(memory ? "/dev/shm" : "/tmp") + "/facezip-fuzz-XXXXXX";
      if (::mkdtemp(pattern.data()) == nullptr) abort();
      path = pattern;
    }
    ~Folder() {
      std::error_code ignored;
      std::filesystem::remove_all(path, ignored);
    }
    std::filesystem::path path;
  } made;
  return made.path;
}

/// Writes the bytes to a file of that name in folder(), and returns it.
inline std::filesystem::path fileOf(const char* name, const std::uint8_t* data, std::size_t size) {
  const std::filesystem::path file = folder() / name;
  const int descriptor = ::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
  if (descriptor < 0) abort();
  for (std::size_t done = 0; done < size;) {
    const ssize_t written = ::write(descriptor, data + done, size - done);
    if (written <= 0) abort();
    done += static_cast<std::size_t>(written);
  }
  ::close(descriptor);
  return file;
}

}  // namespace facezip::fuzz
