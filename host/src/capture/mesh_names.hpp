// mesh_names.hpp - what the name of an OBJ file says about it.
#pragma once

#include <algorithm>
#include <string_view>

namespace facezip {

/// The neutral, as it is called here and in ICT-FaceKit.
inline bool isNeutralMesh(std::string_view stem) {
  return stem == "neutral" || stem == "generic_neutral" || stem == "generic_neutral_mesh";
}

/// Another person's neutral ("identity042" in ICT-FaceKit): no expression and no shape.
inline bool isIdentityMesh(std::string_view stem) {
  constexpr std::string_view kStart = "identity";
  if (!stem.starts_with(kStart) || stem.size() == kStart.size()) return false;
  stem.remove_prefix(kStart.size());
  return std::all_of(stem.begin(), stem.end(), [](char c) { return '0' <= c && c <= '9'; });
}

}  // namespace facezip
