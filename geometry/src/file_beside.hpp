// file_beside.hpp - files that a mesh names.
#pragma once

#include <filesystem>
#include <string>

namespace facezip::geometry {

/// The file of that name in the folder of `file`: where a path leads elsewhere, its last part. Empty if there is none.
std::filesystem::path fileBeside(const std::filesystem::path& file, std::string name);

}  // namespace facezip::geometry
