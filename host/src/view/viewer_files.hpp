// viewer_files.hpp - the bundled page, compiled in (host/cmake/embed_files.cmake).
#pragma once

#include <map>
#include <string_view>

namespace facezip::view {

const std::map<std::string_view, std::string_view>& embeddedViewerFiles();

}  // namespace facezip::view
