// iris.hpp - eyes, painted: a small set of colours, and what an eyeball looks like at each point.
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

namespace facezip::rig {

/// sRGB, 0 to 255.
using Colour = std::array<double, 3>;

struct Iris {
  std::string name;
  Colour inner;  ///< around the pupil
  Colour outer;  ///< the rest
};

/// The set, from dark to light.
const std::vector<Iris>& irises();

/// One of the set by its name, or the one whose colour is nearest to #rrggbb as eyes see it (CIELAB).
/// text  "" for the first choice of the set. option  for messages. Throws InputError that lists the names.
const Iris& findIris(const std::string& text, const std::string& option);

/// Colour of an eyeball, sRGB, 0 to 255.
/// angle    from the middle of the pupil, seen from the eyeball's centre, radians
/// azimuth  around it, radians
Colour eyeColour(const Iris& iris, double angle, double azimuth);

}  // namespace facezip::rig
