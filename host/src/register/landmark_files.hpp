// landmark_files.hpp - landmarks.json of scans and of a template.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <map>
#include <string>

namespace facezip::registration {

/// Scan, then landmark, to where it lies, in the scans' unit.
using ScanLandmarks = std::map<std::string, std::map<std::string, Eigen::RowVector3d>>;
/// Landmark to vertex of the template, from 0.
using TemplateLandmarks = std::map<std::string, int>;

/// {"SCAN": {"LANDMARK": [x, y, z], ...}, ...}. Throws InputError naming the field that is wrong.
ScanLandmarks readScanLandmarks(const std::filesystem::path& file);

/// The same of a text that is at hand. name_of_text  where it came from, for messages
ScanLandmarks parseScanLandmarks(const std::string& text, const std::string& name_of_text);

/// {"LANDMARK": VERTEX, ...}. vertices  of the template. Throws InputError naming the field that is wrong.
TemplateLandmarks readTemplateLandmarks(const std::filesystem::path& file, int vertices);

}  // namespace facezip::registration
