#include "facezip/reconstruct.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <vector>

#include "blend/band_blender.hpp"
#include "blend/blend_memory.hpp"
#include "blend/names.hpp"
#include "image/image_file.hpp"
#include "io/counts.hpp"
#include "io/memory_bound.hpp"
#include "io/staged_directory.hpp"
#include "package/package_files.hpp"
#include "package/package_json.hpp"

namespace facezip {
namespace fs = std::filesystem;
namespace {

/// Larger bands gain nothing.
constexpr std::uint64_t kUsefulBandBytes = std::uint64_t{256} << 20;
/// Image files open at once: a process may hold 1024 by default. More expressions take another pass over the textures.
constexpr std::uint64_t kMostFiles = 200;

/// How the memory that is left is shared; images of any height pass through.
struct Share {
  std::uint64_t band_bytes;  ///< textures of a band and one frame of it
  std::size_t files_at_once;
};

/// Throws InputError where a band of one row of tiles, and one file, do not fit.
Share shareMemory(const Package& package, const PackageMap& map, std::uint64_t memory_bytes) {
  const std::uint64_t beside = blend::weightBytes(package) + blend::stagingBytes(map, package.differences());
  const std::uint64_t file = blend::writerBytes(map);
  const std::uint64_t least = beside + file + blend::bandBytes(map, package.differences());
  io::requireMemory(least, memory_bytes, "map " + map.name + " of " + package.directory().string());
  const std::uint64_t left = memory_bytes - io::kProcessBytes - beside;
  const std::uint64_t band = std::clamp(left / 2, blend::bandBytes(map, package.differences()), kUsefulBandBytes);
  return {band, static_cast<std::size_t>(std::clamp<std::uint64_t>((left - band) / file, 1, kMostFiles))};
}

std::vector<int> chosenExpressions(const Package& package, std::span<const std::string> names) {
  std::vector<int> chosen;
  if (names.empty()) {
    for (std::size_t n = 0; n < package.expressions().size(); ++n) chosen.push_back(static_cast<int>(n));
  }
  for (const std::string& name : names) chosen.push_back(blend::expressionIndex(package, name, "expression"));
  std::set<int> seen;
  for (const int n : chosen) {
    if (seen.insert(n).second) continue;
    throw InputError({"", "expression", "each once", package.expressions()[toSize(n)] + " twice", ""});
  }
  return chosen;
}

std::vector<image::ImageWriter> openWriters(const Package& package, const PackageMap& map,
                                            std::span<const int> expressions, const fs::path& folder) {
  const char* extension = map.sample_type == SampleType::kFloat32 ? ".exr" : ".png";
  std::vector<image::ImageWriter> writers;
  for (const int n : expressions) {
    writers.emplace_back(folder / (package.expressions()[toSize(n)] + extension), package::neutralShape(map),
                         map.colour_space);
  }
  return writers;
}

/// One pass over the textures of a map, for a few expressions.
void reconstructMap(const Package& package, const PackageMap& map, blend::BandBlender& blender,
                    std::uint64_t band_bytes, std::span<const int> expressions, const fs::path& folder,
                    Progress& progress, std::size_t& done) {
  std::vector<image::ImageWriter> writers = openWriters(package, map, expressions, folder);
  const int band_rows = blender.rowsWithin(band_bytes);
  std::vector<float> beta(package.expressions().size(), 0.0f);
  std::vector<std::byte> frame;
  for (int begin = 0; begin < map.height; begin += band_rows) {
    const int rows = std::min(band_rows, map.height - begin);
    blender.loadRows(begin, begin + rows);
    frame.resize(toSize(rows) * package::neutralShape(map).rowBytes());
    for (std::size_t w = 0; w < writers.size(); ++w) {
      progress.checkCancelled();
      const std::size_t n = toSize(expressions[w]);
      beta[n] = 1.0f;
      blender.blend(beta, frame);
      beta[n] = 0.0f;
      writers[w].writeRows(frame, rows);
      progress.advance(done += toSize(rows));
    }
  }
  for (image::ImageWriter& writer : writers) writer.close();
}

std::size_t totalRows(const Package& package, std::size_t expressions) {
  std::size_t rows = 0;
  for (const PackageMap& map : package.maps()) rows += toSize(map.height) * expressions;
  return rows;
}

/// What is reconstructed has the names of captured textures, and may have those of a package's: it replaces neither.
void requireNoCapture(const Package& package, const fs::path& output) {
  std::vector<fs::path> signs = {"capture.json", "neutral.obj", package::kDescriptionFile};
  for (const PackageMap& map : package.maps()) {
    std::error_code error;
    for (const fs::directory_entry& entry : fs::directory_iterator(output / map.name, error)) {
      if (entry.path().stem() == "neutral") signs.push_back(fs::path(map.name) / entry.path().filename());
    }
  }
  for (const fs::path& sign : signs) {
    std::error_code error;
    if (!fs::exists(output / sign, error)) continue;
    throw OutputError(output,
                      fmt::format("it holds \"{}\", as captures and packages do, whose textures are not to be replaced",
                                  sign.string()),
                      "choose another --output");
  }
}

}  // namespace

void reconstruct(const Package& package, const fs::path& output, std::span<const std::string> expressions,
                 const Device& device, Progress& progress, std::uint64_t memory_bytes) {
  const std::vector<int> chosen = chosenExpressions(package, expressions);
  std::vector<Share> shares;  // before any work
  for (const PackageMap& map : package.maps()) shares.push_back(shareMemory(package, map, memory_bytes));
  requireNoCapture(package, output);
  const ProtectedPaths inputs = inputsOf(package);
  inputs.requireApart(output);
  for (const PackageMap& map : package.maps()) inputs.requireApart(output / map.name);
  io::StagedDirectory staged(output, &progress);
  progress.stage("reconstruct", totalRows(package, chosen.size()));
  const auto weights = blend::loadWeightMaps(package, device);
  std::size_t done = 0;
  for (std::size_t m = 0; m < package.maps().size(); ++m) {
    const PackageMap& map = package.maps()[m];
    io::createDirectories(staged.path() / map.name);
    blend::BandBlender blender(package, static_cast<int>(m), weights, device);
    for (std::size_t begin = 0; begin < chosen.size(); begin += shares[m].files_at_once) {
      const std::size_t count = std::min(shares[m].files_at_once, chosen.size() - begin);
      reconstructMap(package, map, blender, shares[m].band_bytes, std::span(chosen).subspan(begin, count),
                     staged.path() / map.name, progress, done);
    }
  }
  staged.commit();
}

}  // namespace facezip
