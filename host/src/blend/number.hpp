// number.hpp - numbers in texts that people write: --weights and animation tables.
#pragma once

#include <optional>
#include <string_view>

namespace facezip::blend {

/// `text` without blanks and carriage returns at its ends.
std::string_view trimmed(std::string_view text);

/// The finite number that all of `text` says, with a decimal point whatever the locale; nothing if it says none.
std::optional<float> parseNumber(std::string_view text);

}  // namespace facezip::blend
