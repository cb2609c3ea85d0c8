// special_file.hpp - what may stand where a file is expected, for tests of everything that reads files.
#pragma once

#include <sys/stat.h>

#include <filesystem>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

namespace facezip::test {

struct SpecialFile {
  std::string name;                                            ///< as messages call it
  std::function<void(const std::filesystem::path& file)> put;  ///< in the place of `file`, which is not there
};

/// Each of these by itself and, where that is another case, by a link.
inline const std::vector<SpecialFile>& specialFiles() {
  namespace fs = std::filesystem;
  static const auto make_pipe = [](const fs::path& file) {
    if (::mkfifo(file.c_str(), 0600) != 0) throw std::runtime_error("cannot make " + file.string());
  };
  static const std::vector<SpecialFile> all = {
      {"a pipe", make_pipe},
      {"a pipe",
       [](const fs::path& file) {
         const fs::path pipe = file.string() + ".pipe";
         make_pipe(pipe);
         fs::create_symlink(pipe.filename(), file);
       }},
      {"a device", [](const fs::path& file) { fs::create_symlink("/dev/zero", file); }},
      {"a folder", [](const fs::path& file) { fs::create_directory(file); }},
      {"a folder", [](const fs::path& file) { fs::create_directory_symlink("/", file); }},
      {"no such file", [](const fs::path& file) { fs::create_symlink("nowhere", file); }},
      {"symbolic links", [](const fs::path& file) { fs::create_symlink(file.filename(), file); }}};
  return all;
}

}  // namespace facezip::test
