#include "facezip/view.hpp"

#include <fmt/format.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "facezip/check.hpp"
#include "io/base64.hpp"
#include "io/file_pieces.hpp"
#include "io/folder.hpp"
#include "io/staged_directory.hpp"
#include "package/footprint.hpp"
#include "view/viewer_files.hpp"

namespace facezip {
namespace fs = std::filesystem;
namespace {

constexpr std::uintmax_t kLargestTexture = std::uintmax_t{4} << 30;

/// Tells the page, before its script runs, that the package's files are scripts.
std::string pageOnDisk(std::string_view page) {
  constexpr std::string_view kBefore = "<script src=\"viewer.js\">";
  std::string text(page);
  text.insert(text.find(kBefore), "<script>globalThis.facezipScripts = true;</script>\n");
  return text;
}

/// A file of the package as a script that hands it to the page.
void writeScript(const OpenPackageFile& file, const fs::path& script) {
  constexpr std::size_t kWholeGroups = std::size_t{3} << 20;  // of base64, which pads the last alone
  std::ofstream out(script, std::ios::binary);
  out << fmt::format("facezipFile({},\"", nlohmann::json(file.name).dump());
  io::forEachPiece(file.file, file.name, kWholeGroups, [&](std::string_view piece) { out << io::base64(piece); });
  out << "\")\n";
  out.close();
  if (!out) throw OutputError(script, "could not be written", "is the disk full?");
}

}  // namespace

const std::map<std::string_view, std::string_view>& viewerPage() { return view::embeddedViewerFiles(); }

std::vector<std::string> packageFiles(const Package& package) { return package::filesOf(package.description()); }

std::vector<OpenPackageFile> openPackageFiles(const Package& package) {
  std::vector<OpenPackageFile> files;
  for (std::string& name : packageFiles(package)) {
    InputFile file = package.folder().open(name, "a file of the package");
    files.push_back({std::move(name), std::move(file)});
  }
  return files;
}

void writeViewer(const Package& package, const fs::path& output, Progress& progress) {
  inputsOf(package).requireApartFromFolder(output);
  checkTexels(package, progress);
  io::StagedDirectory staged(output, {"viewer.js", "facezip"}, &progress);
  for (const auto& [name, text] : viewerPage()) {
    io::writeTextFile(staged.path() / name, name == "index.html" ? pageOnDisk(text) : std::string(text));
  }
  for (const OpenPackageFile& file : openPackageFiles(package)) {
    progress.checkCancelled();
    const fs::path script = staged.path() / "package" / (file.name + ".js");
    io::createDirectories(script.parent_path());
    writeScript(file, script);
  }
  staged.commit();
}

}  // namespace facezip
