// package_form.hpp - the form of a package: the few numbers that its size follows from.
#pragma once

#include <optional>

#include "compress/bands/map_set.hpp"
#include "compress/refine/weight_window.hpp"

namespace facezip::compress {

struct PackageForm {
  int differences = 4;           ///< C
  int weight_scale = 8;          ///< texels of the largest map per weight cell, per axis
  std::optional<int> code_bits;  ///< of difference textures of maps of 16 bits or floats; none: as the fit needs them
};

/// The weight maps of a package of this form.
WeightSpace weightSpace(const MapSet& maps, const PackageForm& form);

}  // namespace facezip::compress
