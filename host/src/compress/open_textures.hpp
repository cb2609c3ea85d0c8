// open_textures.hpp - the textures of a capture, opened, and decoded beside the work.
#pragma once

#include <filesystem>
#include <string>
#include <thread>

#include "bands/map_set.hpp"
#include "device/run.hpp"
#include "facezip/capture.hpp"

namespace facezip::compress {

struct OpenTextures {
  MapSet maps;
  std::string decoded;   ///< how passes read the textures: "scratch file" or "decoded again"
  std::jthread decoder;  ///< fills the scratch files; the last member, so that it ends before what it fills
};

/// Opens every texture. They are decoded once, into scratch files in `scratch_directory`, where its disk has room for
/// them, and again in every pass where it has not.
/// Throws InputError: a texture that does not fit its neutral.
OpenTextures openTextures(const Capture& capture, const std::filesystem::path& scratch_directory,
                          const device::Run& run);

}  // namespace facezip::compress
