// map_fields.hpp - what the descriptions of captures and packages say of a map alike.
#pragma once

#include <string>

#include "io/json_field.hpp"

namespace facezip::image {

inline constexpr int kMaxExpressions = 65536;  ///< N
inline constexpr double kLargestMetricWeight = 1e9;

/// "sRGB", "linear", or "" where it is not known. Throws InputError.
std::string parseColourSpace(const io::JsonField& field);

/// How much a map counts beside the others, 0 to kLargestMetricWeight. Throws InputError.
double parseMetricWeight(const io::JsonField& field);

}  // namespace facezip::image
