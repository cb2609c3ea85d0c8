#include "io/read_file.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <fstream>
#include <sstream>
#include <system_error>
#include <utility>

#include "facezip/error.hpp"

namespace facezip::io {
namespace fs = std::filesystem;

std::string readFile(const fs::path& file, const std::string& expected, const std::string& cure, std::uintmax_t most) {
  std::error_code error;
  if (!fs::exists(file, error)) {
    throw InputError({file.string(), "", expected, error ? error.message() : "no such file", cure});
  }
  if (fs::is_directory(file, error)) throw InputError({file.string(), "", expected, "a folder", cure});
  const std::uintmax_t bytes = fs::file_size(file, error);  // a pipe has no size
  if (!error && bytes > most) {
    throw InputError({file.string(), "", fmt::format("at most {} bytes", most), fmt::format("{}", bytes), ""});
  }
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw InputError({file.string(), "", expected, std::system_category().message(errno), cure});
  std::ostringstream text;
  text << stream.rdbuf();
  if (stream.bad()) throw InputError({file.string(), "", expected, "a file that cannot be read to its end", ""});
  return std::move(text).str();
}

}  // namespace facezip::io
