// landmarks_page.hpp - the page on which landmarks are placed, compiled in.
#pragma once

#include <map>
#include <string_view>

namespace facezip::registration {

/// Texts by file name.
const std::map<std::string_view, std::string_view>& embeddedLandmarksPage();

}  // namespace facezip::registration
