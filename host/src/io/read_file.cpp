#include "io/read_file.hpp"

#include "facezip/input_file.hpp"

namespace facezip::io {

std::string readFile(const std::filesystem::path& file, const std::string& expected, const std::string& cure,
                     std::uintmax_t most) {
  return InputFile(file, expected, cure).read(most);
}

}  // namespace facezip::io
