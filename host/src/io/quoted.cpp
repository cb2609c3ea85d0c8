#include "io/quoted.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "facezip/printable.hpp"

namespace facezip::io {

std::string quoted(const std::string& text) {
  constexpr std::size_t kLongest = 80;
  std::size_t length = std::min(kLongest, text.size());
  while (length > 0 && length < text.size() && (static_cast<unsigned char>(text[length]) & 0xc0u) == 0x80u) --length;
  return fmt::format("\"{}{}\"", printable(std::string_view(text).substr(0, length)),
                     text.size() > kLongest ? "..." : "");
}

}  // namespace facezip::io
