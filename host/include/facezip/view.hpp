// view.hpp - the page that shows a package: a head in a browser, with sliders (host/viewer).
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "facezip/input_file.hpp"
#include "facezip/package.hpp"
#include "facezip/progress.hpp"

namespace facezip {

/// Files of the page by name ("index.html", "viewer.js", "viewer.css"); they lie in the library. The page fetches the
/// files of the package from the folder `package` beside it.
const std::map<std::string_view, std::string_view>& viewerPage();

/// Names of the files of a package, each once, relative to it, package.json first: what a page may read.
std::vector<std::string> packageFiles(const Package& package);

/// One of them, open: it stays what it is whatever takes its place in the folder.
struct OpenPackageFile {
  std::string name;
  InputFile file;
};
/// Opens all of them. Throws InputError.
std::vector<OpenPackageFile> openPackageFiles(const Package& package);

/// Writes a folder whose index.html shows the package in a browser, from a server or straight from disk: browsers let
/// no page fetch files from disk, so that the package's are written as scripts. The folder appears whole or not at all;
/// one that was written by this function before is replaced.
/// Throws InputError for damaged textures, OutputError, Cancelled.
void writeViewer(const Package& package, const std::filesystem::path& output, Progress& progress);

}  // namespace facezip
