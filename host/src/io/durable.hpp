// durable.hpp - bytes on the disk, not in the memory of the kernel: what was published outlives a power cut.
#pragma once

#include <filesystem>

namespace facezip::io {

/// Waits until the disk has what was written to a file. Throws OutputError, also for what the disk had no room for.
void syncFile(const std::filesystem::path& file);

/// Waits until the disk has the names in a folder. File systems that cannot say so are taken at their word.
/// Throws OutputError.
void syncFolder(const std::filesystem::path& folder);

/// Both, for all files and folders below `folder` and itself.
void syncTree(const std::filesystem::path& folder);

}  // namespace facezip::io
