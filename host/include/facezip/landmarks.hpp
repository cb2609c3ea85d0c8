// landmarks.hpp - scans and a template for a page on which landmarks are placed. Unstable.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "facezip/input_file.hpp"
#include "facezip/progress.hpp"

namespace facezip {

/// Files of the page: landmarks.html, landmarks.js, viewer.css and landmarks.css.
const std::map<std::string_view, std::string_view>& landmarksPage();

/// What the page shows, as files that lie in a folder of this object's own.
class LandmarkSession {
 public:
  struct File {
    std::string name;
    InputFile file;
  };
  static constexpr std::size_t kMostBytes = std::size_t{1} << 20;  ///< of landmarks

  /// Reads all scans (as registerScans() does; a scan needs no texture here) and the template.
  /// landmarks  the one file that save() writes; empty: SCANS/landmarks.json. It need not be there
  /// Throws InputError, OutputError (no room for temporary files), Cancelled.
  LandmarkSession(const std::filesystem::path& scans, const std::filesystem::path& template_directory,
                  const std::filesystem::path& landmarks, Progress& progress);
  ~LandmarkSession();

  /// scene.json, and what it names: meshes of corners, textures of at most 2048 texels a side as PNG.
  const std::vector<File>& files() const;
  const std::filesystem::path& landmarkFile() const;

  /// Replaces the landmarks of the scans that `text` names, {"SCAN": {"LANDMARK": [x, y, z]}}, at once or not at all;
  /// those of other scans stay. Throws InputError where the text is no such thing or names no scan, OutputError.
  void save(const std::string& text) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace facezip
