#include "device/pocl_cache.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <memory>
#include <mutex>
#include <system_error>

#include "facezip/error.hpp"
#include "io/scratch_directory.hpp"

namespace facezip::device {
namespace fs = std::filesystem;
namespace {

constexpr const char* kVariable = "POCL_CACHE_DIR";

const char* valueOf(const char* variable) {
  const char* value = std::getenv(variable);
  return value == nullptr || *value == '\0' ? nullptr : value;
}

/// Where PoCL would go.
fs::path cacheFolder() {
  if (const char* folder = valueOf(kVariable)) return folder;
  if (const char* base = valueOf("XDG_CACHE_HOME")) return fs::path(base) / "pocl/kcache";
  if (const char* home = valueOf("HOME")) return fs::path(home) / ".cache/pocl/kcache";
  return "/tmp/pocl/kcache";
}

bool canBeWrittenTo(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);  // as PoCL does
  return !error && ::access(folder.c_str(), W_OK | X_OK) == 0;
}

}  // namespace

void givePoclAPlace() {
  static std::once_flag once;
  std::call_once(once, [] {
    if (valueOf(kVariable) != nullptr || canBeWrittenTo(cacheFolder())) return;
    try {
      static const io::ScratchDirectory scratch;
      ::setenv(kVariable, scratch.path().c_str(), 1);
    } catch (const OutputError&) {
      // No place at all: poclCacheFault() says so, if PoCL is what is missing.
    }
  });
}

std::string poclCacheFault() {
  const fs::path folder = cacheFolder();
  if (canBeWrittenTo(folder)) return "";
  return fmt::format("PoCL needs a folder for its kernels, and {} cannot be written to: set {} to one that can",
                     folder.string(), kVariable);
}

}  // namespace facezip::device
