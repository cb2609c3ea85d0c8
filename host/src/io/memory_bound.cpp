#include "io/memory_bound.hpp"

#include <fmt/format.h>

#include "facezip/error.hpp"

namespace facezip::io {
namespace {

std::string mebibytes(std::uint64_t bytes) {
  constexpr std::uint64_t kMiB = std::uint64_t{1} << 20;
  return fmt::format("{} MiB", bytes / kMiB + (bytes % kMiB != 0 ? 1 : 0));
}

}  // namespace

void requireMemory(std::uint64_t needed, std::uint64_t memory_bytes, const std::string& what) {
  if (needed <= memory_bytes && memory_bytes - needed >= kProcessBytes) return;
  throw InputError({"--memory", "", fmt::format("at least {} for {}", mebibytes(needed + kProcessBytes), what),
                    mebibytes(memory_bytes), "raise it, if the package is to be trusted with that much"});
}

}  // namespace facezip::io
