// loaded_formats.cpp - OpenImageIO as a module that is loaded when a file asks for it, for programs that start often.
#include "image/image_format.hpp"
#include "io/load_module.hpp"

namespace facezip::image {

AnyFormat& anyFormat() {
  static AnyFormat& formats = reinterpret_cast<AnyFormat& (*)()>(
      io::loadModule(FACEZIP_OIIO_MODULE, kOpenImageIoEntry, "which reads and writes images other than PNG"))();
  return formats;
}

}  // namespace facezip::image
