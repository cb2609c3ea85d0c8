#include "image/input_extensions.hpp"

#include <algorithm>
#include <cctype>
#include <iterator>
#include <string>
#include <string_view>

namespace facezip::image {
namespace {

// Of OIIO::get_extension_map(), but for its formats "null" and "term", which read no files.
constexpr std::string_view kExtensions[] = {
    "png",  "tif", "tiff", "exr", "tga",  "bmp",  "jpg", "jpeg",                                           // common
    "dib",  "cin", "dds",  "dcm", "dpx",  "fits", "gif", "hdr",  "heic",  "heif", "heics", "avif", "ico",  // others
    "iff",  "z",   "jpe",  "jif", "jfif", "jfi",  "jp2", "j2k",  "j2c",   "sxr",  "mxr",   "vdb",  "ppm",  //
    "pgm",  "pbm", "pnm",  "pfm", "psd",  "pdd",  "psb", "rla",  "sgi",   "rgb",  "rgba",  "bw",   "int",  //
    "inta", "pic", "tpic", "tx",  "env",  "sm",   "vsm", "webp", "zfile",                                  //
    "avi",  "mov", "qt",   "mp4", "m4a",  "3gp",  "3g2", "mj2",  "m4v",   "mpg",                           // films
    "bay",  "bmq", "cr2",  "cr3", "crw",  "cs1",  "dc2", "dcr",  "dng",   "erf",  "fff",   "k25",  "kdc",  // raw
    "mdc",  "mos", "mrw",  "nef", "orf",  "pef",  "pxn", "raf",  "raw",   "rdc",  "sr2",   "srf",  "x3f",  //
    "arw",  "3fr", "cine", "ia",  "kc2",  "nrw",  "qtk", "rw2",  "sti",   "rwl",  "srw",   "drf",  "dsc",  //
    "ptx",  "cap", "iiq",  "rwz"};

}  // namespace

bool hasImageExtension(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  if (extension.empty()) return false;
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return std::find(std::begin(kExtensions), std::end(kExtensions), std::string_view(extension).substr(1)) !=
         std::end(kExtensions);
}

}  // namespace facezip::image
