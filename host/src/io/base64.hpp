// base64.hpp - bytes as text (RFC 4648).
#pragma once

#include <string>
#include <string_view>

namespace facezip::io {

std::string base64(std::string_view bytes);

}  // namespace facezip::io
