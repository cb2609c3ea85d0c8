#include "io/file_pieces.hpp"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <string>
#include <system_error>

#include "facezip/error.hpp"

namespace facezip::io {

void forEachPiece(const InputFile& file, const std::string& path, std::size_t bytes,
                  const std::function<void(std::string_view piece)>& visit) {
  std::string piece;
  for (std::uintmax_t done = 0; done < file.size(); done += piece.size()) {
    piece.resize(static_cast<std::size_t>(std::min<std::uintmax_t>(bytes, file.size() - done)));
    for (std::size_t filled = 0; filled < piece.size();) {
      const ssize_t got =
          ::pread(file.descriptor(), piece.data() + filled, piece.size() - filled, static_cast<off_t>(done + filled));
      if (got < 0 && errno == EINTR) continue;
      if (got <= 0) {
        throw InputError({path, "", "a file that can be read to its end",
                          got == 0 ? "one that was cut" : std::system_category().message(errno), ""});
      }
      filled += static_cast<std::size_t>(got);
    }
    visit(piece);
  }
}

}  // namespace facezip::io
