// write_stage.hpp - pass 3: writes what the groups hold.
#pragma once

#include <vector>

#include "compress/compression_state.hpp"

namespace facezip::compress {

/// Writes the package into the staged directory, over an attempt before. Returns the squared error of every group, fit
/// weights in it, where difference textures were fitted; the report gets the errors of their maps.
std::vector<double> writeGroups(CompressionState& state);

}  // namespace facezip::compress
