#include "device/program_cache.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <system_error>

namespace facezip::device {
namespace fs = std::filesystem;
namespace {

/// A file is this, the key, the binary. The key is kept in full: two that share a file name are told apart.
struct Header {
  char magic[16];
  std::uint64_t key_bytes;
  std::uint64_t binary_bytes;
  std::uint64_t checksum;  // of the binary: drivers need not survive a damaged one
};
constexpr char kMagic[16] = "facezip-cl-1\n";

/// FNV-1a: to name files and to find damage, not against forgery.
template <typename Bytes>
std::uint64_t hashOf(const Bytes& bytes) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (const auto b : bytes) hash = (hash ^ static_cast<unsigned char>(b)) * 0x100000001b3u;
  return hash;
}

/// An entry under a name of this thread's own, for renaming.
void writeFile(const fs::path& file, std::string_view key, const std::vector<unsigned char>& binary) {
  Header header{{}, key.size(), binary.size(), hashOf(binary)};
  std::memcpy(header.magic, kMagic, sizeof(kMagic));
  std::ofstream stream(file, std::ios::binary);
  stream.exceptions(std::ios::failbit | std::ios::badbit);
  stream.write(reinterpret_cast<const char*>(&header), sizeof(header));
  stream.write(key.data(), static_cast<std::streamsize>(key.size()));
  stream.write(reinterpret_cast<const char*>(binary.data()), static_cast<std::streamsize>(binary.size()));
  stream.close();
}

}  // namespace

ProgramCache ProgramCache::ofUser() {
  if (const char* folder = std::getenv("FACEZIP_CACHE_DIR")) return ProgramCache(folder);
  // A relative XDG_CACHE_HOME is to be ignored, by the specification.
  if (const char* base = std::getenv("XDG_CACHE_HOME"); base != nullptr && base[0] == '/') {
    return ProgramCache(fs::path(base) / "facezip");
  }
  if (const char* home = std::getenv("HOME"); home != nullptr && home[0] == '/') {
    return ProgramCache(fs::path(home) / ".cache" / "facezip");
  }
  return ProgramCache({});
}

fs::path ProgramCache::fileOf(std::string_view key) const {
  return folder_ / fmt::format("{:016x}.clbin", hashOf(key));
}

std::optional<std::vector<unsigned char>> ProgramCache::find(std::string_view key) const {
  if (folder_.empty()) return std::nullopt;
  std::ifstream stream(fileOf(key), std::ios::binary | std::ios::ate);
  const std::streamoff file_bytes = stream.tellg();
  stream.seekg(0);
  Header header;
  if (!stream.read(reinterpret_cast<char*>(&header), sizeof(header))) return std::nullopt;
  // Sizes of a damaged file may be anything: they are believed only when they add up.
  const auto rest = static_cast<std::uint64_t>(file_bytes) - sizeof(header);
  if (std::memcmp(header.magic, kMagic, sizeof(kMagic)) != 0 || header.key_bytes != key.size() || rest < key.size() ||
      header.binary_bytes != rest - key.size()) {
    return std::nullopt;
  }
  std::string kept_key(key.size(), '\0');
  std::vector<unsigned char> binary(header.binary_bytes);
  stream.read(kept_key.data(), static_cast<std::streamsize>(kept_key.size()));
  if (!stream.read(reinterpret_cast<char*>(binary.data()), static_cast<std::streamsize>(binary.size()))) {
    return std::nullopt;
  }
  if (kept_key != key || hashOf(binary) != header.checksum) return std::nullopt;
  return binary;
}

void ProgramCache::store(std::string_view key, const std::vector<unsigned char>& binary) const noexcept {
  if (folder_.empty() || binary.empty()) return;
  static std::atomic<unsigned> count = 0;
  fs::path partial;
  std::error_code error;
  try {
    // What is in it will be run: nobody else may write there.
    if (fs::create_directories(folder_)) fs::permissions(folder_, fs::perms::owner_all);
    const fs::path file = fileOf(key);
    partial = folder_ / fmt::format(".partial-{}-{}", ::getpid(), count++);
    writeFile(partial, key, binary);
    fs::rename(partial, file);
  } catch (const std::exception&) {
    fs::remove(partial, error);  // a full or read-only disk: the next process compiles again
  }
}

}  // namespace facezip::device
