#include "io/scratch_directory.hpp"

#include <cstdlib>
#include <string>
#include <system_error>

#include "facezip/error.hpp"

namespace facezip::io {
namespace fs = std::filesystem;
namespace {

constexpr const char* kName = "facezip-scratch";
constexpr const char* kCure = "set TMPDIR to a folder that can be written to";

fs::path temporaryDirectory() {
  // Not temp_directory_path(), whose message does not say where the name comes from.
  const char* named = std::getenv("TMPDIR");
  const fs::path folder = named != nullptr && *named != '\0' ? named : "/tmp";
  std::error_code error;
  if (fs::is_directory(folder, error)) return fs::absolute(folder);
  throw OutputError(folder, "the directory for temporary files is no folder", kCure);
}

}  // namespace

ScratchDirectory::ScratchDirectory() {
  const fs::path target = temporaryDirectory() / kName;
  try {
    removeLeftovers(target, nullptr);
    folder_ = makeUnfinishedFolder(target, Access::kOwner);
  } catch (const OutputError& error) {
    throw OutputError(target.parent_path(), error.reason(), kCure);
  }
}

ScratchDirectory::~ScratchDirectory() {
  std::error_code ignored;
  fs::remove_all(folder_->path, ignored);
}

}  // namespace facezip::io
