// composed.hpp - one spelling for names that look the same.
#pragma once

#include <string>

namespace facezip::io {

/// The text in Unicode's composed form (NFC), in which names are compared: an accented letter is one character from
/// most keyboards, a letter and an accent in files that macOS wrote. What is not UTF-8 is returned as it is.
std::string composed(const std::string& text);

}  // namespace facezip::io
