#include "blocks/texture_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cassert>
#include <cerrno>
#include <system_error>
#include <utility>

#include "blocks/dds_file.hpp"
#include "blocks/ktx2_file.hpp"
#include "facezip/error.hpp"
#include "io/file_at.hpp"

namespace facezip::blocks {
namespace fs = std::filesystem;
namespace {

bool isKtx2(const fs::path& path) {
  const fs::path extension = path.extension();
  if (extension == ".ktx2") return true;
  if (extension == ".dds") return false;
  throw InputError({path.string(), "", "a name that ends in .ktx2 or .dds", extension.string(), ""});
}

TextureInFile place(const fs::path& path, const BlockTexture& texture) {
  assert(texture.levels >= 1 && texture.levels <= mostLevels(texture.width, texture.height));
  const bool ktx2 = isKtx2(path);
  const int largest = ktx2 ? kLargestKtx2Side : kLargestDdsSide;
  if (texture.width > largest || texture.height > largest) {
    throw InputError({path.string(), "", fmt::format("at most {0} x {0} texels", largest),
                      fmt::format("{} x {}", texture.width, texture.height), ktx2 ? "" : "choose KTX2"});
  }
  if (!ktx2 && isAstc(texture.format)) {
    throw InputError(
        {path.string(), "", "a BC format: DDS has no others", std::string(infoOf(texture.format).name), "choose KTX2"});
  }
  if (texture.srgb && infoOf(texture.format).vk_srgb == 0) {
    throw InputError({path.string(), "", "a format that has a variant for sRGB",
                      std::string(infoOf(texture.format).name), "choose bc7 or bc1"});
  }
  return ktx2 ? ktx2Layout(texture) : ddsLayout(texture);
}

}  // namespace

TextureFileReader::TextureFileReader(fs::path path, InputFile file)
    : path_(std::move(path)),
      file_(std::move(file)),
      places_(isKtx2(path_) ? readKtx2(path_, file_) : readDds(path_, file_)) {}

void TextureFileReader::readRows(int level, int begin, int end, std::span<std::byte> blocks) const {
  assert(level >= 0 && level < texture().levels);
  assert(begin >= 0 && begin <= end && end <= blockRows(texture(), level));
  const std::size_t row_bytes = blockRowBytes(texture(), level);
  assert(blocks.size() == static_cast<std::size_t>(end - begin) * row_bytes);
  const std::uint64_t offset =
      places_.level_begins[static_cast<std::size_t>(level)] + static_cast<std::uint64_t>(begin) * row_bytes;
  const std::string fault = io::readAt(file_.descriptor(), offset, blocks);
  if (fault.empty()) return;
  throw InputError({path_.string(), fmt::format("level {}, rows of blocks {} to {}", level, begin, end - 1),
                    "a file that can be read to its end", fault, "the file is truncated or damaged: replace it"});
}

std::vector<std::byte> TextureFileReader::readLevel(int level) const {
  std::vector<std::byte> blocks(levelBytes(texture(), level));
  readRows(level, 0, blockRows(texture(), level), blocks);
  return blocks;
}

TextureFileWriter::TextureFileWriter(fs::path path, const BlockTexture& texture)
    : path_(std::move(path)), places_(place(path_, texture)), written_(static_cast<std::size_t>(texture.levels)) {
  descriptor_ = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor_ < 0) throw OutputError(path_, std::system_category().message(errno));
}

TextureFileWriter::~TextureFileWriter() {
  if (descriptor_ < 0) return;
  struct stat status {};
  // Never a device that somebody wrote to.
  if (::fstat(descriptor_, &status) == 0 && S_ISREG(status.st_mode)) ::unlink(path_.c_str());
  ::close(descriptor_);
}

void TextureFileWriter::write(std::uint64_t offset, std::span<const std::byte> bytes) {
  const std::string fault = io::writeAt(descriptor_, offset, bytes);
  if (!fault.empty()) throw OutputError(path_, fault);
}

void TextureFileWriter::append(int level, std::span<const std::byte> blocks) {
  const auto l = static_cast<std::size_t>(level);
  assert(l < written_.size() && blocks.size() % blockRowBytes(places_.texture, level) == 0);
  assert(written_[l] + blocks.size() <= levelBytes(places_.texture, level));
  write(places_.level_begins[l] + written_[l], blocks);
  written_[l] += blocks.size();
}

void TextureFileWriter::close() {
  for ([[maybe_unused]] std::size_t l = 0; l < written_.size(); ++l) {
    assert(written_[l] == levelBytes(places_.texture, static_cast<int>(l)));
  }
  // Last: these are the bytes that readers tell a texture by.
  write(0, (isKtx2(path_) ? ktx2Header(places_.texture) : ddsHeader(places_.texture)).bytes());
  if (::close(std::exchange(descriptor_, -1)) == 0) return;
  const int error = errno;
  ::unlink(path_.c_str());  // a device does not fail here
  throw OutputError(path_, std::system_category().message(error));
}

}  // namespace facezip::blocks
