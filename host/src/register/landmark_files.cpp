#include "register/landmark_files.hpp"

#include "io/json_field.hpp"
#include "io/read_file.hpp"

namespace facezip::registration {
namespace {
using io::JsonField;

constexpr const char* kCure = "see docs/registration.md";
constexpr double kFarthest = 1e9;  // of a coordinate, in any unit

}  // namespace

ScanLandmarks readScanLandmarks(const std::filesystem::path& file) {
  return parseScanLandmarks(io::readFile(file, "landmarks of the scans", kCure), file.string());
}

ScanLandmarks parseScanLandmarks(const std::string& text, const std::string& name_of_text) {
  const nlohmann::json json = io::parseJson(text, name_of_text, kCure);
  const JsonField root(json, name_of_text, "", kCure);
  ScanLandmarks landmarks;
  for (const auto& [scan, points] : root.object().items()) {
    const JsonField of_scan = root[scan];
    for (const auto& [name, point] : of_scan.object().items()) {
      Eigen::RowVector3d& place = landmarks[scan][name];
      Eigen::Index axis = 0;
      for (const JsonField& coordinate : of_scan[name].elements(3, 3)) {
        place[axis++] = coordinate.number(-kFarthest, kFarthest);
      }
    }
  }
  return landmarks;
}

TemplateLandmarks readTemplateLandmarks(const std::filesystem::path& file, int vertices) {
  const nlohmann::json json =
      io::parseJson(io::readFile(file, "landmarks of the template", kCure), file.string(), kCure);
  const JsonField root(json, file.string(), "", kCure);
  TemplateLandmarks landmarks;
  for (const auto& [name, vertex] : root.object().items()) landmarks[name] = root[name].integer(0, vertices - 1);
  return landmarks;
}

}  // namespace facezip::registration
