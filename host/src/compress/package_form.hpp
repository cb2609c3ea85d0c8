// package_form.hpp - the form of a package: the few numbers that its size follows from.
#pragma once

#include <optional>

#include "bands/map_set.hpp"
#include "facezip/block_format.hpp"
#include "refine/weight_window.hpp"

namespace facezip::compress {

/// Blocks of the maps of 8 bits.
struct TextureFormats {
  BlockFormat neutral = BlockFormat::kBc7;
  BlockFormat differences = BlockFormat::kBc7;
};

struct PackageForm {
  int differences = 4;           ///< C
  int weight_scale = 8;          ///< texels of the largest map per weight cell, per axis
  std::optional<int> code_bits;  ///< of difference textures of maps of 16 bits or floats; none: as the fit needs them
  std::optional<TextureFormats> blocks;  ///< none: all textures are images
  bool weights_per_map = false;          ///< a set of weights for every map; else one for all
};

/// The weight maps of a package of this form.
WeightSpace weightSpace(const MapSet& maps, const PackageForm& form);

}  // namespace facezip::compress
