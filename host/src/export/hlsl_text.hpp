// hlsl_text.hpp - docs/blend.md in HLSL, with the numbers of one package: what exports for Unity and Unreal share.
#pragma once

#include <string>
#include <vector>

#include "export/engine_maps.hpp"

namespace facezip::exporting {

/// Which row of a texture the engine's Load() calls 0, and its v = 0.
enum class Rows { kFromTop, kFromBottom };

/// host/shaders/facezip_blend.h and, for every map,
///   float4 facezip_ID(float2 uv, SamplerState state, Texture2D<float4> ...)     T, as it is stored; v = 0 on top
/// with the textures of mapTextures(). Sampled one by one, since engines import plain images best; weight maps are read
/// from the atlas. Needs fz_beta, `storage` float[N]: `storage` is "static " for globals, "" for members of a struct.
/// kept  blocks that are uploaded as they are, whose row 0 is the top
std::string hlslFunctions(const Package& package, const std::vector<EngineMap>& maps, Rows rows,
                          const std::string& storage, KeptBlocks kept);

/// Names of the textures that facezip_ID() takes, in its order; files are NAME.png, of blocks NAME.fzktx2.
std::vector<std::string> mapTextures(const Package& package, const EngineMap& map);

/// Writes textures/ for these: neutrals, difference textures one by one, weight atlases.
/// kept  blocks that stay: KTX2 files as the package has them
void writePlainTextures(const Package& package, const std::vector<EngineMap>& maps, const std::filesystem::path& folder,
                        Progress& progress, KeptBlocks kept);

}  // namespace facezip::exporting
