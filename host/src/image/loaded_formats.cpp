// loaded_formats.cpp - OpenImageIO as a module that is loaded when a file asks for it, for programs that start often.
#include <dlfcn.h>
#include <fmt/format.h>

#include "facezip/error.hpp"
#include "image/image_format.hpp"

namespace facezip::image {
namespace {

AnyFormat& load() {
  // Found through the RUNPATH of the program or library that this is part of. Never unloaded: what it made may outlive
  // us.
  void* module = ::dlopen(FACEZIP_OIIO_MODULE, RTLD_NOW | RTLD_LOCAL);
  void* entry = module == nullptr ? nullptr : ::dlsym(module, kOpenImageIoEntry);
  if (entry == nullptr) {
    const char* reason = ::dlerror();
    throw Error(
        fmt::format("cannot load {}, which reads and writes images other than PNG: {}; is facezip installed whole?",
                    FACEZIP_OIIO_MODULE, reason == nullptr ? "no reason given" : reason));
  }
  return reinterpret_cast<AnyFormat& (*)()>(entry)();
}

}  // namespace

AnyFormat& anyFormat() {
  static AnyFormat& formats = load();
  return formats;
}

}  // namespace facezip::image
