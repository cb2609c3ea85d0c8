#include "package/file_copy.hpp"

#include <fstream>
#include <string_view>

#include "io/file_pieces.hpp"
#include "io/folder.hpp"

namespace facezip::package {

void copyFile(const Package& package, const std::string& name, const std::filesystem::path& to) {
  const InputFile file = package.folder().open(name, "a file of the package");
  std::ofstream out(to, std::ios::binary);
  io::forEachPiece(file, (package.directory() / name).string(), std::size_t{1} << 20,
                   [&](std::string_view piece) { out << piece; });
  out.close();
  if (!out) throw OutputError(to, "could not be written", "is the disk full?");
}

}  // namespace facezip::package
