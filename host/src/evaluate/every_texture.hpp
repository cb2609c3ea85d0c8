// every_texture.hpp - what a studio does without facezip: every captured texture in blocks, each for itself.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "bands/map_set.hpp"
#include "evaluate/subject.hpp"
#include "facezip/block_format.hpp"
#include "facezip/evaluate.hpp"

namespace facezip::evaluate {

/// Key in the results: "every-bc7".
std::string everyTextureKey(BlockFormat format);

/// Errors of the expressions' textures as their blocks decode; none for maps of more than 8 bits, which blocks do not
/// hold. BC formats are coded at Quality::kNormal, ASTC as `astcenc -medium` does. Takes a pass over the textures.
/// Throws InputError, DeviceError, Cancelled.
std::optional<MapErrors> everyTextureErrors(const compress::OpenMap& map, BlockFormat format, const Subject& subject);

/// Bytes of the neutral and every expression: in blocks, or as they are where blocks do not hold them.
std::uint64_t everyTextureBytes(const PackageMap& map, BlockFormat format, int expressions);

}  // namespace facezip::evaluate
