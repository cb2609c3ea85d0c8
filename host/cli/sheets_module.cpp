#include "sheets_module.hpp"

#include "contact_sheet.hpp"
#include "error_sheet.hpp"

#define FACEZIP_EXPORT __attribute__((visibility("default")))

FACEZIP_EXPORT void facezipWriteContactSheet(const std::filesystem::path& file, const facezip::Capture& capture,
                                             const facezip::Package& package, const std::filesystem::path& decoded) {
  facezip::cli::writeContactSheet(file, capture, package, decoded);
}

FACEZIP_EXPORT void facezipWriteErrorSheet(const std::filesystem::path& file, const facezip::Evaluation& evaluation,
                                           const std::vector<std::string>& titles) {
  facezip::cli::writeErrorSheet(file, evaluation, titles);
}
