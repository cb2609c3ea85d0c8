#include "device/program_cache.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <fstream>

#include "facezip/error.hpp"
#include "io/read_file.hpp"
#include "io/write_file.hpp"

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

/// Throws std::exception where it cannot all be written.
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
  std::string file;
  try {
    file = io::readFile(fileOf(key), "a compiled kernel");
  } catch (const InputError&) {
    return std::nullopt;  // not there yet
  }
  Header header;
  if (file.size() < sizeof(header) + key.size()) return std::nullopt;
  std::memcpy(&header, file.data(), sizeof(header));
  const std::string_view rest = std::string_view(file).substr(sizeof(header));
  // Sizes of a damaged file may be anything: they are believed only when they add up.
  if (std::memcmp(header.magic, kMagic, sizeof(kMagic)) != 0 || header.key_bytes != key.size() ||
      header.binary_bytes != rest.size() - key.size() || rest.substr(0, key.size()) != key) {
    return std::nullopt;
  }
  const std::string_view binary = rest.substr(key.size());
  if (hashOf(binary) != header.checksum) return std::nullopt;
  return std::vector<unsigned char>(binary.begin(), binary.end());
}

void ProgramCache::store(std::string_view key, const std::vector<unsigned char>& binary) const noexcept {
  if (folder_.empty() || binary.empty()) return;
  try {
    // What is in it will be run: nobody else may write there.
    if (fs::create_directories(folder_)) fs::permissions(folder_, fs::perms::owner_all);
    io::StagedFile staged(fileOf(key), nullptr, io::Durability::kKernel);
    writeFile(staged.path(), key, binary);
    staged.commit();
  } catch (const std::exception&) {
    // A full or read-only disk: the next process compiles again.
  }
}

}  // namespace facezip::device
