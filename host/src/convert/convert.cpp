// convert.cpp - a package with its textures in other blocks, loop closed on its own frames.
#include "facezip/convert.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>

#include "blend/blend_memory.hpp"
#include "blocks/block_format.hpp"
#include "convert/converted_files.hpp"
#include "convert/frame_distance.hpp"
#include "convert/map_conversion.hpp"
#include "convert/shown_texels.hpp"
#include "facezip/check.hpp"
#include "facezip/method.hpp"
#include "facezip/rig.hpp"
#include "io/staged_directory.hpp"
#include "package/footprint.hpp"
#include "package/package_textures.hpp"

namespace facezip {
namespace {
using namespace convert;
namespace fs = std::filesystem;
using Sets = std::vector<std::unique_ptr<ConvertedSet>>;

/// Weights of other methods mean something (clusters, influences): they stay, as compressCapture() leaves them. So do
/// those of a rig, whose shapes blend to its expressions: fitted each to its own frame, their errors would add up.
bool refitsWeights(const Package& package) {
  if (isRig(package)) return false;
  const nlohmann::json record = nlohmann::json::parse(package.methodJson());
  const auto name = record.find("name");
  if (name == record.end() || !name->is_string()) return true;
  const std::optional<Method> method = findNamed<Method>(name->get<std::string>());
  return !method || *method == Method::kRefined;
}

void requireOneInBlocks(const Package& package) {
  if (std::ranges::any_of(package.maps(), package::hasBlocks)) return;
  throw InputError({package.directory().string(), "textures", "some in blocks, for --texture-format png",
                    "images alone", "take a block format: " + blockFormatNames()});
}

void requireFormats(const Package& package, const compress::TextureFormats& formats, Progress& progress) {
  bool any = false;
  for (const PackageMap& map : package.maps()) {
    if (!fitsBlocks(map)) {
      progress.note(fmt::format("map {} has {} samples, more than blocks hold: it is copied", map.name,
                                image::sampleTypeName(map.sample_type)));
      continue;
    }
    any = true;
    for (const BlockFormat format : {formats.neutral, formats.differences}) {
      try {
        blocks::requireChannels(blocks::formatFor(format, map.channels), map.channels);
      } catch (const InputError& error) {
        InputError::Parts parts = error.parts();
        parts.item = "map " + map.name;
        throw InputError(parts);
      }
    }
  }
  if (any) return;
  throw InputError(
      {package.directory().string(), "maps", "one of 8 bits, which blocks hold", "16 bits or floats alone", ""});
}

ConvertReport::Map describe(const PackageMap& before, const PackageMap& after) {
  const auto bytes = [](const PackageMap& map) {
    std::uint64_t sum = package::bytesInMemory(package::neutralTexture(map));
    for (int i = 0; i < static_cast<int>(map.differences.size()); ++i) {
      package::StoredTexture texture = package::differenceTexture(map, i);
      sum += package::bytesInMemory(texture);
    }
    return sum;
  };
  ConvertReport::Map map;
  map.name = after.name;
  map.texture_format = after.neutral_format;
  map.difference_format = after.differences.front().format;
  map.bytes_before = bytes(before);
  map.bytes_after = bytes(after);
  return map;
}

/// Classes of a map that was converted; of one whose blocks became images, found now. None where it was copied.
std::shared_ptr<const raster::TexelClasses> classesOf(const Package& package, int index, const Sets& sets,
                                                      const std::optional<geometry::TriangleMesh>& mesh,
                                                      Progress& progress) {
  for (const auto& set : sets) {
    const auto at = std::ranges::find(set->indices, index);
    if (at != set->indices.end()) return set->maps.maps[toSize(at - set->indices.begin())].classes;
  }
  const PackageMap& map = package.maps()[toSize(index)];
  if (!sets.empty() || !fitsBlocks(map)) return nullptr;
  return findShownTexels(package, index, mesh, readWeights(package, map.weight_set), spaceOf(package, map.weight_set),
                         progress)
      .classes;
}

}  // namespace

ConvertReport convertPackage(const Package& package, const fs::path& output, const ConvertOptions& options,
                             const Device& device, Progress& progress) {
  inputsOf(package).requireApartFromFolder(output);
  std::optional<compress::TextureFormats> formats;
  if (options.texture_format) {
    formats = {*options.texture_format, options.difference_format.value_or(*options.texture_format)};
    requireFormats(package, *formats, progress);
  } else {
    requireOneInBlocks(package);
  }
  io::StageClock clock;
  const std::uint64_t weight_bytes = 2 * blend::weightBytes(package);
  const device::Run run{device.context(), progress, clock,
                        options.memory_bytes - std::min(options.memory_bytes, weight_bytes)};
  checkTexels(package, progress, options.memory_bytes);
  clock.book("reading");
  const std::optional<geometry::TriangleMesh> mesh = uvMesh(package, options.memory_bytes);
  const blend::WeightSets weights = blend::loadWeightMaps(package, device);
  io::StagedDirectory staged(output, package::footprint(), &progress);

  Sets sets;
  std::uint64_t kept = 0;
  for (int set = 0; formats && set < static_cast<int>(package.weightSets().size()); ++set) {
    sets.push_back(convertSet({package, device, *formats, refitsWeights(package), mesh, weights, run}, set, kept));
    kept += sets.back()->neutralBytes() + sets.back()->weights.codes.size();
  }
  if (formats) {
    writeConverted(package, sets, staged.path(), run);
  } else {
    writeAsImages(package, staged.path(), progress);
  }
  clock.book("writing");

  ConvertReport report;
  {
    const Package written = Package::open(staged.path());
    const blend::WeightSets written_weights = blend::loadWeightMaps(written, device);
    for (std::size_t m = 0; m < package.maps().size(); ++m) {
      report.maps.push_back(describe(package.maps()[m], written.maps()[m]));
      const auto classes = classesOf(package, static_cast<int>(m), sets, mesh, progress);
      if (!classes) continue;
      report.maps.back().rmse = frameDistance({package, weights}, {written, written_weights}, static_cast<int>(m),
                                              *classes, device, progress);
    }
    report.memory_before = package.bytesInMemory();
    report.memory_after = written.bytesInMemory();
    report.disk_before = package.bytesOnDisk();
    report.disk_after = written.bytesOnDisk();
  }
  clock.book("comparing");
  staged.commit();
  clock.book("publishing");
  report.seconds = clock.seconds();
  report.device = device.info().name;
  return report;
}

}  // namespace facezip
