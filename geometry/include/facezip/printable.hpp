// printable.hpp - texts of strangers, such as names of files, as they may be shown.
#pragma once

#include <string>
#include <string_view>

namespace facezip {

/// `text` in one line of UTF-8 that does nothing to a terminal and hides nothing from a reader: control characters,
/// marks that reorder or join what stands beside them, and bytes that are no UTF-8 are spelt out (\x1b, \u{202e}).
/// Whatever else stands there stays as it is; what was made printable once is not changed by doing so again.
std::string printable(std::string_view text);

/// The same line by line: '\n' stays.
std::string printableLines(std::string_view text);

}  // namespace facezip
