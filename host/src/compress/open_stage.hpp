// open_stage.hpp - before the first pass: textures opened, meshes read, masks solved (FaceZip 3.1, "Mask Computation"),
// bands planned.
#pragma once

#include <thread>

#include "compress/compression_state.hpp"

namespace facezip::compress {

/// Opens the textures of every map and returns the thread that decodes them from here on, beside the work; none where
/// the disk has no room for them. Throws InputError.
std::jthread openTextures(CompressionState& state);

/// Mesh, region, samples, masks. Throws InputError, SolverError.
void readGeometry(CompressionState& state);

/// How the maps lie on the face and on the weight grid, and how large a band may be. Throws InputError.
void planBands(CompressionState& state);

}  // namespace facezip::compress
