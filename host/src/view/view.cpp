#include "facezip/view.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "facezip/check.hpp"
#include "io/base64.hpp"
#include "io/read_file.hpp"
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

}  // namespace

const std::map<std::string_view, std::string_view>& viewerPage() { return view::embeddedViewerFiles(); }

std::vector<std::string> packageFiles(const Package& package) { return package::filesOf(package.description()); }

void writeViewer(const Package& package, const fs::path& output, Progress& progress) {
  inputsOf(package).requireApartFromFolder(output);
  checkTexels(package, progress);
  io::StagedDirectory staged(output, {"viewer.js", "facezip"}, &progress);
  for (const auto& [name, text] : viewerPage()) {
    io::writeTextFile(staged.path() / name, name == "index.html" ? pageOnDisk(text) : std::string(text));
  }
  for (const std::string& name : packageFiles(package)) {
    progress.checkCancelled();
    const fs::path file = staged.path() / "package" / (name + ".js");
    io::createDirectories(file.parent_path());
    io::writeTextFile(file, fmt::format("facezipFile({},\"{}\")\n", nlohmann::json(name).dump(),
                                        io::base64(io::readFile(package.directory() / name, "a file of the package", "",
                                                                kLargestTexture))));
  }
  staged.commit();
}

}  // namespace facezip
