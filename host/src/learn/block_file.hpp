// block_file.hpp - named blocks of numbers in one file: what models are kept in (docs/model_format.md). Files come from
// strangers: nothing in them is code, every size is checked against the file before memory is taken.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "facezip/error.hpp"
#include "facezip/input_file.hpp"
#include "facezip/progress.hpp"

namespace facezip::learn {

enum class BlockType : std::uint32_t { kFloat = 1, kInteger = 2, kText = 3 };

/// An array of floats or integers of 32 bits, or text. Row-major.
struct Block {
  BlockType type = BlockType::kFloat;
  std::vector<std::uint64_t> shape;
  std::vector<float> floats;
  std::vector<std::int32_t> integers;
  std::string text;
};

/// Blocks by name.
class Blocks {
 public:
  explicit Blocks(std::filesystem::path file = {}) : file_(std::move(file)) {}

  void add(const std::string& name, std::vector<std::uint64_t> shape, std::vector<float> values);
  void add(const std::string& name, std::vector<std::uint64_t> shape, std::vector<std::int32_t> values);
  void add(const std::string& name, std::string text);

  bool has(const std::string& name) const { return blocks_.contains(name); }
  /// Extents in `shape` are what the block must have. Throw InputError naming the file and the block.
  const std::vector<float>& floats(const std::string& name, const std::vector<std::uint64_t>& shape) const;
  const std::vector<std::int32_t>& integers(const std::string& name, const std::vector<std::uint64_t>& shape) const;
  const std::string& text(const std::string& name) const;
  /// The shape of a block of that type and number of axes. Throws InputError.
  const std::vector<std::uint64_t>& shapeOf(const std::string& name, BlockType type, std::size_t axes) const;

  /// Throws the InputError of a block.
  [[noreturn]] void fail(const std::string& name, const std::string& expected, const std::string& got) const;

  const std::map<std::string, Block>& all() const { return blocks_; }
  const std::filesystem::path& file() const { return file_; }

 private:
  friend Blocks readBlocks(const std::filesystem::path& file);

  const Block& block(const std::string& name, BlockType type) const;

  std::filesystem::path file_;
  std::map<std::string, Block> blocks_;
};

/// Throws InputError for a file that is none of these, is cut short, goes on or claims what it does not have; for
/// floats that are not finite.
Blocks readBlocks(const std::filesystem::path& file);

/// Writes the file whole or not at all. Returns its bytes. Throws OutputError.
std::uint64_t writeBlocks(const std::filesystem::path& file, const Blocks& blocks, Progress& progress);

}  // namespace facezip::learn
