// quoted.hpp - text that came from a file, as messages show it.
#pragma once

#include <string>

namespace facezip::io {

/// Quotes text that came from a file for a message: without control characters, cut where it is long.
std::string quoted(const std::string& text);

}  // namespace facezip::io
