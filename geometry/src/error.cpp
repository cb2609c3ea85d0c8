#include "facezip/error.hpp"

#include <fmt/format.h>

#include <utility>

#include "facezip/printable.hpp"

namespace facezip {
namespace {

std::string describe(const InputError::Parts& parts) {
  std::string text = parts.file;
  const auto append = [&text](const char* separator, const std::string& part) {
    if (part.empty()) return;
    if (!text.empty()) text += separator;
    text += part;
  };
  append(": ", parts.item);
  append(": ", parts.expected.empty() ? "" : "expected " + parts.expected);
  append(parts.expected.empty() ? ": " : ", ", parts.got.empty() ? "" : "got " + parts.got);
  append("; ", parts.cure);
  return printable(text);
}

std::string describe(const std::filesystem::path& file, const std::string& reason, const std::string& cure) {
  std::string text = file.string() + ": cannot write: " + reason;
  if (!cure.empty()) text += "; " + cure;
  return printable(text);
}

}  // namespace

InputError::InputError(Parts parts) : Error(describe(parts)), parts_(std::move(parts)) {}

InputError InputError::in(const std::string& file) const {
  Parts parts = parts_;
  if (parts.file.empty()) parts.file = file;
  return InputError(std::move(parts));
}

OutputError::OutputError(const std::filesystem::path& file, const std::string& reason, const std::string& cure)
    : Error(describe(file, reason, cure)), file_(file), reason_(reason), cure_(cure) {}

SolverError::SolverError(const std::string& step, long size, double residual)
    : Error(step + ": the linear system with " + std::to_string(size) + " unknowns was not solved (relative residual " +
            fmt::format("{:.3g}", residual) + ")"),
      size_(size),
      residual_(residual) {}

}  // namespace facezip
