#include "file_beside.hpp"

#include <algorithm>
#include <system_error>

namespace facezip::geometry {

std::filesystem::path fileBeside(const std::filesystem::path& file, std::string name) {
  namespace fs = std::filesystem;
  std::replace(name.begin(), name.end(), '\\', '/');
  std::error_code error;
  for (const fs::path& candidate : {fs::path(name).lexically_normal(), fs::path(name).filename()}) {
    if (candidate.empty() || candidate.is_absolute() || *candidate.begin() == "..") continue;
    const fs::path beside = file.parent_path() / candidate;
    if (fs::is_regular_file(beside, error)) return beside;
  }
  return {};
}

}  // namespace facezip::geometry
