#include "image/map_fields.hpp"

#include "io/quoted.hpp"

namespace facezip::image {

std::string parseColourSpace(const io::JsonField& field) {
  const std::string name = field.text();
  if (name != "sRGB" && name != "linear" && !name.empty()) field.fail("\"sRGB\", \"linear\" or \"\"", io::quoted(name));
  return name;
}

double parseMetricWeight(const io::JsonField& field) { return field.number(0, kLargestMetricWeight); }

}  // namespace facezip::image
