#include "learn/block_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>

#include "io/quoted.hpp"
#include "io/write_file.hpp"

namespace facezip::learn {
namespace fs = std::filesystem;
namespace {

static_assert(std::endian::native == std::endian::little, "numbers stand in the file as they do in memory");

constexpr char kMagic[9] = "facezipM";
constexpr std::uint32_t kVersion = 1;
constexpr std::uint32_t kMostBlocks = 65536;
constexpr std::uint32_t kMostName = 400;  // names of shapes and maps have 200 bytes
constexpr std::uint32_t kMostAxes = 4;
/// Bytes: as much as any model of a head takes by far.
constexpr std::uint64_t kMostBytes = std::uint64_t{4} << 30;
constexpr char kCure[] = "take a file that `facezip train` wrote, or train again";

std::uint64_t bytesOf(BlockType type) { return type == BlockType::kText ? 1 : 4; }

/// Reads numbers from what stands in memory; never beyond it.
class Cursor {
 public:
  Cursor(const std::string& bytes, std::string file) : bytes_(bytes), file_(std::move(file)) {}

  template <typename Number>
  Number number(const char* item) {
    Number value{};
    std::memcpy(&value, take(sizeof(value), item), sizeof(value));
    return value;
  }
  std::string text(std::uint64_t count, const char* item) { return {take(count, item), count}; }
  const char* take(std::uint64_t count, const char* item) {
    if (count > bytes_.size() - at_) fail(item, fmt::format("{} bytes more", count), "the end of the file");
    const char* here = bytes_.data() + at_;
    at_ += count;
    return here;
  }
  bool atEnd() const { return at_ == bytes_.size(); }
  std::uint64_t left() const { return bytes_.size() - at_; }

  [[noreturn]] void fail(const std::string& item, const std::string& expected, const std::string& got) const {
    throw InputError({file_, item, expected, got, kCure});
  }

 private:
  const std::string& bytes_;
  std::string file_;
  std::size_t at_ = 0;
};

/// One entry of the table that stands before the numbers.
struct Entry {
  std::string name;
  Block block;
  std::uint64_t count = 0;  ///< of numbers, or of bytes of text
};

std::uint64_t countOf(const Entry& entry, const Cursor& cursor) {
  std::uint64_t count = 1;
  for (const std::uint64_t extent : entry.block.shape) {
    if (extent > kMostBytes || (extent > 0 && count > kMostBytes / extent)) {
      cursor.fail(io::quoted(entry.name), "a block that the file can hold",
                  fmt::format("{}", fmt::join(entry.block.shape, " x ")));
    }
    count *= extent;
  }
  return count;
}

Entry readEntry(Cursor& cursor) {
  Entry entry;
  const auto length = cursor.number<std::uint32_t>("name of a block");
  if (length == 0 || length > kMostName) {
    cursor.fail("name of a block", fmt::format("1 to {} bytes", kMostName), fmt::format("{}", length));
  }
  entry.name = cursor.text(length, "name of a block");
  const auto type = cursor.number<std::uint32_t>("type of a block");
  if (type < 1 || type > 3) cursor.fail(io::quoted(entry.name), "a type from 1 to 3", fmt::format("{}", type));
  entry.block.type = static_cast<BlockType>(type);
  const auto axes = cursor.number<std::uint32_t>("axes of a block");
  if (axes < 1 || axes > kMostAxes) {
    cursor.fail(io::quoted(entry.name), fmt::format("1 to {} axes", kMostAxes), fmt::format("{}", axes));
  }
  for (std::uint32_t axis = 0; axis < axes; ++axis) {
    entry.block.shape.push_back(cursor.number<std::uint64_t>("shape of a block"));
  }
  entry.count = countOf(entry, cursor);
  return entry;
}

void readNumbers(Cursor& cursor, Entry& entry) {
  const std::uint64_t bytes = entry.count * bytesOf(entry.block.type);
  const char* from = cursor.take(bytes, entry.name.c_str());
  Block& block = entry.block;
  if (block.type == BlockType::kText) {
    block.text.assign(from, bytes);
  } else if (block.type == BlockType::kInteger) {
    block.integers.resize(entry.count);
    std::memcpy(block.integers.data(), from, bytes);
  } else {
    block.floats.resize(entry.count);
    std::memcpy(block.floats.data(), from, bytes);
    const bool finite = std::ranges::all_of(block.floats, [](float value) { return std::isfinite(value); });
    if (!finite) cursor.fail(io::quoted(entry.name), "finite numbers", "NaN or infinity");
  }
}

void append(std::string& bytes, const void* from, std::size_t count) {
  bytes.append(static_cast<const char*>(from), count);
}

template <typename Number>
void append(std::string& bytes, Number value) {
  append(bytes, &value, sizeof(value));
}

std::string headerOf(const Blocks& blocks) {
  std::string header(kMagic, 8);
  append(header, kVersion);
  append(header, static_cast<std::uint32_t>(blocks.all().size()));
  for (const auto& [name, block] : blocks.all()) {
    append(header, static_cast<std::uint32_t>(name.size()));
    append(header, name.data(), name.size());
    append(header, static_cast<std::uint32_t>(block.type));
    append(header, static_cast<std::uint32_t>(block.shape.size()));
    for (const std::uint64_t extent : block.shape) append(header, extent);
  }
  return header;
}

const char* typeName(BlockType type) {
  return type == BlockType::kFloat ? "floats" : type == BlockType::kInteger ? "integers" : "text";
}

}  // namespace

void Blocks::add(const std::string& name, std::vector<std::uint64_t> shape, std::vector<float> values) {
  blocks_[name] = {BlockType::kFloat, std::move(shape), std::move(values), {}, {}};
}

void Blocks::add(const std::string& name, std::vector<std::uint64_t> shape, std::vector<std::int32_t> values) {
  blocks_[name] = {BlockType::kInteger, std::move(shape), {}, std::move(values), {}};
}

void Blocks::add(const std::string& name, std::string text) {
  const std::uint64_t size = text.size();
  blocks_[name] = {BlockType::kText, {size}, {}, {}, std::move(text)};
}

const Block& Blocks::block(const std::string& name, BlockType type) const {
  const auto found = blocks_.find(name);
  if (found == blocks_.end()) fail(name, typeName(type), "no such block");
  if (found->second.type != type) fail(name, typeName(type), typeName(found->second.type));
  return found->second;
}

const std::vector<std::uint64_t>& Blocks::shapeOf(const std::string& name, BlockType type, std::size_t axes) const {
  const Block& found = block(name, type);
  if (found.shape.size() != axes) fail(name, fmt::format("{} axes", axes), fmt::format("{}", found.shape.size()));
  return found.shape;
}

const std::vector<float>& Blocks::floats(const std::string& name, const std::vector<std::uint64_t>& shape) const {
  const Block& found = block(name, BlockType::kFloat);
  if (found.shape != shape) {
    fail(name, fmt::format("{}", fmt::join(shape, " x ")), fmt::format("{}", fmt::join(found.shape, " x ")));
  }
  return found.floats;
}

const std::vector<std::int32_t>& Blocks::integers(const std::string& name,
                                                  const std::vector<std::uint64_t>& shape) const {
  const Block& found = block(name, BlockType::kInteger);
  if (found.shape != shape) {
    fail(name, fmt::format("{}", fmt::join(shape, " x ")), fmt::format("{}", fmt::join(found.shape, " x ")));
  }
  return found.integers;
}

const std::string& Blocks::text(const std::string& name) const { return block(name, BlockType::kText).text; }

void Blocks::fail(const std::string& name, const std::string& expected, const std::string& got) const {
  throw InputError({file_.string(), io::quoted(name), expected, got, kCure});
}

Blocks readBlocks(const fs::path& file) {
  const InputFile input(file, "a model that `facezip train` wrote", kCure);
  const std::string bytes = input.read(kMostBytes);
  Cursor cursor(bytes, file.string());
  if (bytes.size() < 8 || std::memcmp(bytes.data(), kMagic, 8) != 0) {
    cursor.fail("first bytes", fmt::format("\"{}\": a model that `facezip train` wrote", kMagic), "others");
  }
  cursor.take(8, "first bytes");
  const auto version = cursor.number<std::uint32_t>("version");
  if (version != kVersion) cursor.fail("version", fmt::format("{}", kVersion), fmt::format("{}", version));
  const auto count = cursor.number<std::uint32_t>("number of blocks");
  if (count > kMostBlocks) {
    cursor.fail("number of blocks", fmt::format("at most {}", kMostBlocks), fmt::format("{}", count));
  }
  std::vector<Entry> entries;  // grows as the file has them, not as it claims
  std::uint64_t claimed = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    entries.push_back(readEntry(cursor));
    claimed += entries.back().count * bytesOf(entries.back().block.type);
  }
  if (claimed != cursor.left()) {
    cursor.fail("blocks", fmt::format("{} bytes, as their shapes say", claimed), fmt::format("{}", cursor.left()));
  }
  Blocks blocks(file);
  for (Entry& entry : entries) {
    readNumbers(cursor, entry);
    if (!blocks.blocks_.emplace(entry.name, std::move(entry.block)).second) {
      cursor.fail(io::quoted(entry.name), "one block of a name", "two");
    }
  }
  return blocks;
}

std::uint64_t writeBlocks(const fs::path& file, const Blocks& blocks, Progress& progress) {
  if (file.has_parent_path()) io::createDirectories(file.parent_path());
  io::StagedFile staged(file, &progress);
  std::ofstream out(staged.path(), std::ios::binary);
  const std::string header = headerOf(blocks);
  std::uint64_t written = header.size();
  out.write(header.data(), static_cast<std::streamsize>(header.size()));
  for (const auto& [name, block] : blocks.all()) {
    const void* from = block.type == BlockType::kText      ? static_cast<const void*>(block.text.data())
                       : block.type == BlockType::kInteger ? static_cast<const void*>(block.integers.data())
                                                           : static_cast<const void*>(block.floats.data());
    const std::uint64_t bytes = bytesOf(block.type) * (block.type == BlockType::kText      ? block.text.size()
                                                       : block.type == BlockType::kInteger ? block.integers.size()
                                                                                           : block.floats.size());
    out.write(static_cast<const char*>(from), static_cast<std::streamsize>(bytes));
    written += bytes;
  }
  out.close();
  if (!out) throw OutputError(file, "cannot be written", "is the disk full?");
  staged.commit();
  return written;
}

}  // namespace facezip::learn
