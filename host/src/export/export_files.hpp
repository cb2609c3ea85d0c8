// export_files.hpp - scripts and shaders that exports bring, compiled in (host/export, host/shaders, host/viewer).
#pragma once

#include <map>
#include <string_view>

namespace facezip::exporting {

const std::map<std::string_view, std::string_view>& embeddedExportFiles();

}  // namespace facezip::exporting
