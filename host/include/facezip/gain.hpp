// gain.hpp - how strong each expression and each region shows in the textures, as an artist tuned it in the viewer.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "facezip/package.hpp"

namespace facezip {

/// Factors on Eq. 8:  w_i(q) = (1 + sum_r (h_r - 1) R_r(q)) sum_n g_n beta_n W_n[i](q)
/// R_r  region r, the sum of its masks (docs/blend.md). The mesh does not know of gains.
struct Gain {
  std::vector<float> expressions;         ///< N, g_n, 0 or more
  std::vector<float> regions;             ///< h_r, one for each region of the package, 0 or more
  std::vector<std::vector<float>> cells;  ///< of each weight set: the bracket, tile_height x tile_width; empty: all 1
};

/// The gain that changes nothing.
Gain unitGain(const Package& package);

/// Works `cells` out of `regions`. Throws InputError for damaged masks.
void applyRegions(const Package& package, Gain& gain);

/// Reads a preset (docs/blend.md); what it does not name has a gain of 1.
/// Throws InputError naming the file: not a preset, of another package, a name that the package does not have, a gain
/// that is not 0 to 16.
Gain readGain(const std::filesystem::path& file, const Package& package);

}  // namespace facezip
