// option_types.hpp - values of options that are more than a number or a word.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <string>

namespace facezip::cli {

/// "2GiB", "512 MB", "1.5 gb", "1000B": a number of bytes; upper and lower case are alike. A number without a unit is
/// refused: nobody means 40 bytes. Throws InputError naming `option`.
std::uint64_t parseBytes(const std::string& option, const std::string& text);

/// A whole number from 0 to 2^64 - 1. Throws InputError naming `option`.
std::uint64_t parseSeed(const std::string& option, const std::string& text);

/// For options that are numbers: refuse what is none from its first character to its last. CLI11 itself takes 010 for
/// 8, 0x10 for 16 and true for 1.
const CLI::Validator& wholeNumber();
const CLI::Validator& decimalNumber();

/// 1234567 as "1.23 MB" (decimal, as the paper's tables count).
std::string formatMegabytes(std::uint64_t bytes);

}  // namespace facezip::cli
