#include "io/file_pieces.hpp"

#include <algorithm>
#include <cstdint>
#include <span>
#include <string>

#include "facezip/error.hpp"
#include "io/file_at.hpp"

namespace facezip::io {

void forEachPiece(const InputFile& file, const std::string& path, std::size_t bytes,
                  const std::function<void(std::string_view piece)>& visit) {
  std::string piece;
  for (std::uintmax_t done = 0; done < file.size(); done += piece.size()) {
    piece.resize(static_cast<std::size_t>(std::min<std::uintmax_t>(bytes, file.size() - done)));
    const std::string fault = readAt(file.descriptor(), done, std::as_writable_bytes(std::span(piece)));
    if (!fault.empty()) throw InputError({path, "", "a file that can be read to its end", fault, ""});
    visit(piece);
  }
}

}  // namespace facezip::io
