#include "compress/package_form.hpp"

namespace facezip::compress {

WeightSpace weightSpace(const MapSet& maps, const PackageForm& form) {
  const OpenMap& largest = maps.maps[maps.reference];
  const image::ImageShape& shape = largest.samples->shape();
  const auto cells = [&form](int side) { return (side + form.weight_scale - 1) / form.weight_scale; };
  return {cells(shape.width), cells(shape.height), form.differences, largest.samples->expressions()};
}

}  // namespace facezip::compress
