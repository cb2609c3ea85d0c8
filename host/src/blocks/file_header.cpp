#include "blocks/file_header.hpp"

#include <fmt/format.h>

#include <cassert>

#include "facezip/error.hpp"
#include "io/file_at.hpp"

namespace facezip::blocks {

FileHeader::FileHeader(const std::filesystem::path& path, const InputFile& file, std::size_t count) : bytes_(count) {
  const std::string fault = io::readAt(file.descriptor(), 0, bytes_);
  if (fault.empty()) return;
  throw InputError({path.string(), "", fmt::format("a file of blocks: {} bytes before them", count), fault,
                    "the file is truncated or another: replace it"});
}

std::string_view FileHeader::text(std::size_t offset, std::size_t size) const {
  assert(offset + size <= bytes_.size());
  return {reinterpret_cast<const char*>(bytes_.data()) + offset, size};
}

void FileHeader::addText(std::string_view text) {
  const auto* bytes = reinterpret_cast<const std::byte*>(text.data());
  bytes_.insert(bytes_.end(), bytes, bytes + text.size());
}

std::uint64_t FileHeader::number(std::size_t offset, std::size_t count) const {
  assert(offset + count <= bytes_.size());
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < count; ++i) value |= std::to_integer<std::uint64_t>(bytes_[offset + i]) << (8 * i);
  return value;
}

void FileHeader::add(std::uint64_t value, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) bytes_.push_back(static_cast<std::byte>(value >> (8 * i)));
}

void HeaderChecks::require(bool good, const std::string& item, const std::string& expected, const std::string& got,
                           const std::string& cure) const {
  if (!good) throw InputError({path_, item, expected, got, cure});
}

void HeaderChecks::requireEqual(const std::string& item, std::uint64_t expected, std::uint64_t got,
                                const std::string& cure) const {
  require(got == expected, item, fmt::format("{}", expected), fmt::format("{}", got), cure);
}

int HeaderChecks::integer(const std::string& item, std::uint32_t value, int most) const {
  require(value >= 1 && value <= static_cast<std::uint32_t>(most), item, fmt::format("1 to {}", most),
          fmt::format("{}", value));
  return static_cast<int>(value);
}

void HeaderChecks::requireWhole(const TextureInFile& texture, const InputFile& file) const {
  require(file.size() == texture.file_bytes, "", fmt::format("{} bytes", texture.file_bytes),
          fmt::format("{}", file.size()), "the file is truncated or damaged: replace it");
}

}  // namespace facezip::blocks
