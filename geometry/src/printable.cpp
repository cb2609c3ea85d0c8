#include "facezip/printable.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>

namespace facezip {
namespace {

struct CodePoint {
  std::uint32_t value = 0;
  std::size_t bytes = 0;  ///< 0: what stands there is no UTF-8
};

/// The first code point of `text`, which is not empty. Overlong forms and surrogates are no UTF-8.
CodePoint firstOf(std::string_view text) {
  const auto byte = [text](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char lead = byte(0);
  if (lead < 0x80) return {lead, 1};
  const std::size_t bytes = lead >= 0xf0 ? 4 : lead >= 0xe0 ? 3 : 2;
  if (lead < 0xc2 || lead > 0xf4 || text.size() < bytes) return {};
  std::uint32_t value = lead & (0x7fu >> bytes);
  for (std::size_t i = 1; i < bytes; ++i) {
    if ((byte(i) & 0xc0u) != 0x80u) return {};
    value = value << 6 | (byte(i) & 0x3fu);
  }
  constexpr std::array<std::uint32_t, 5> kLeast = {0, 0, 0x80, 0x800, 0x10000};
  if (value < kLeast[bytes] || value > 0x10ffff || (value >= 0xd800 && value <= 0xdfff)) return {};
  return {value, bytes};
}

/// Code points that are not seen, or that change how others are.
bool isHidden(std::uint32_t value) {
  struct Range {
    std::uint32_t first, last;
  };
  static constexpr Range kHidden[] = {{0x00, 0x1f},     {0x7f, 0x9f},     {0xad, 0xad},      {0x061c, 0x061c},
                                      {0x180e, 0x180e}, {0x200b, 0x200f}, {0x2028, 0x202e},  {0x2060, 0x206f},
                                      {0xfeff, 0xfeff}, {0xfff9, 0xfffb}, {0xe0000, 0xe007f}};
  return std::any_of(std::begin(kHidden), std::end(kHidden),
                     [value](const Range& range) { return range.first <= value && value <= range.last; });
}

std::string shown(std::string_view text, bool keep_lines) {
  std::string out;
  while (!text.empty()) {
    const CodePoint code = firstOf(text);
    const std::size_t bytes = std::max<std::size_t>(code.bytes, 1);
    if (code.bytes == 0 || (code.value < 0x80 && isHidden(code.value) && !(keep_lines && code.value == '\n'))) {
      out += fmt::format("\\x{:02x}", static_cast<unsigned char>(text.front()));
    } else if (code.value >= 0x80 && isHidden(code.value)) {
      out += fmt::format("\\u{{{:x}}}", code.value);
    } else {
      out += text.substr(0, bytes);
    }
    text.remove_prefix(bytes);
  }
  return out;
}

}  // namespace

std::string printable(std::string_view text) { return shown(text, /*keep_lines=*/false); }
std::string printableLines(std::string_view text) { return shown(text, /*keep_lines=*/true); }

}  // namespace facezip
