// loaded_sheets.cpp - contact_sheet.hpp and error_sheet.hpp by a module, since they need OpenImageIO: most commands do
// not, and would wait longer for its libraries than for their own work.
#include <dlfcn.h>
#include <fmt/format.h>

#include "contact_sheet.hpp"
#include "error_sheet.hpp"
#include "sheets_module.hpp"

namespace facezip::cli {
namespace {

template <typename Function>
Function* entryOf(const char* name) {
  void* module = ::dlopen(FACEZIP_SHEETS_MODULE, RTLD_NOW | RTLD_LOCAL);
  void* entry = module == nullptr ? nullptr : ::dlsym(module, name);
  if (entry == nullptr) {
    const char* reason = ::dlerror();
    throw Error(fmt::format("cannot load {}, which draws pictures: {}; is facezip installed whole?",
                            FACEZIP_SHEETS_MODULE, reason == nullptr ? "no reason given" : reason));
  }
  return reinterpret_cast<Function*>(entry);
}

}  // namespace

void writeContactSheet(const std::filesystem::path& file, const Capture& capture, const Package& package,
                       const std::filesystem::path& decoded) {
  entryOf<decltype(facezipWriteContactSheet)>("facezipWriteContactSheet")(file, capture, package, decoded);
}

void writeErrorSheet(const std::filesystem::path& file, const Evaluation& evaluation,
                     const std::vector<std::string>& titles) {
  entryOf<decltype(facezipWriteErrorSheet)>("facezipWriteErrorSheet")(file, evaluation, titles);
}

}  // namespace facezip::cli
