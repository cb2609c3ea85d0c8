#include "io/load_module.hpp"

#include <dlfcn.h>
#include <fmt/format.h>

#include "facezip/error.hpp"

namespace facezip::io {

void* loadModule(const char* file, const char* entry, const char* what) {
  void* module = ::dlopen(file, RTLD_NOW | RTLD_LOCAL);
  void* found = module == nullptr ? nullptr : ::dlsym(module, entry);
  if (found != nullptr) return found;
  const char* reason = ::dlerror();
  throw Error(fmt::format("cannot load {}, {}: {}; is facezip installed whole?", file, what,
                          reason == nullptr ? "no reason given" : reason));
}

}  // namespace facezip::io
