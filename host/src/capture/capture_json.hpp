// capture_json.hpp - capture.json, the optional description of a capture (docs/capture_format.md).
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace facezip {

inline constexpr const char* kCaptureFile = "capture.json";

/// What capture.json says; everything is optional. Names are composed (io/composed.hpp).
struct CaptureJson {
  struct Map {
    std::string colour_space;
    double weight = 1.0;
    std::string folder;                              ///< relative to the capture; "": the one of the map's name
    std::string neutral;                             ///< file relative to the capture, "" if not named
    std::map<std::string, std::string> expressions;  ///< expression to file relative to the capture
  };
  std::string name;
  std::string unit;
  std::string neutral;  ///< what the neutral's files are called; "": "neutral"
  std::string neutral_mesh;
  std::string mesh;         ///< in neutral_mesh, where that holds several
  std::optional<int> tile;  ///< of UDIM
  std::string meshes;       ///< folder of the expressions' meshes, relative to the capture; "" if not named
  std::string face_region;
  std::string coverage;
  std::string importance;
  std::vector<std::string> expressions;
  std::map<std::string, std::string> expression_meshes;  ///< expression to file relative to the capture
  std::map<std::string, Map> maps;
};

/// Reads `file`; std::nullopt if there is none. Throws InputError naming the field that is malformed.
std::optional<CaptureJson> readCaptureJson(const std::filesystem::path& file);

}  // namespace facezip
