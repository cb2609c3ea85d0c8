// shape_names.hpp - one blendshape under several names: ARKit's, those of rigs, those of FACS
// (host/data/shape_names.json).
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace facezip::blend {

/// A share of a weight, for one expression.
struct Drive {
  std::size_t expression = 0;
  float share = 1.0f;
};

struct NameMatch {
  std::vector<Drive> drives;           ///< none: no expression is called so, or another name drives it
  std::optional<std::size_t> repeats;  ///< an earlier name that says the same as this one
};

/// What each of `given` drives among `names`, which are composed. Exact names go first. Then names of one shape
/// (jawOpen, JawOpen; mouthSmileLeft, mouthSmile_L; upper and lower case alike), for expressions that no exact name
/// drives and where one expression alone has a name of the shape. Then names of several shapes, for what is left: AU12
/// drives mouthSmileLeft and mouthSmileRight, and gets half of each of their weights.
std::vector<NameMatch> matchNames(const std::vector<std::string>& given, const std::vector<std::string>& names);

/// The one of `names` that is called so, exactly or by another name of one shape; none where there is none.
std::optional<std::size_t> findName(const std::string& name, const std::vector<std::string>& names);

/// Does a column of a clip hold something else than weights, as face trackers write it: time, turns of the head?
bool isNoShape(const std::string& name);

}  // namespace facezip::blend
