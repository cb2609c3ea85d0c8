#include "facezip/gain.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "image/image_file.hpp"
#include "io/composed.hpp"
#include "io/counts.hpp"
#include "io/json_field.hpp"
#include "io/quoted.hpp"
#include "io/read_file.hpp"
#include "package/guides.hpp"
#include "package/package_files.hpp"

namespace facezip {
namespace fs = std::filesystem;
namespace {

constexpr double kLargestGain = 16.0;
constexpr const char* kCure = "is this a preset of gains, as `facezip view` saves it?";
constexpr std::uintmax_t kLargestFile = 16u << 20;

void requirePresetOf(const io::JsonField& document, const Package& package, const fs::path& file) {
  for (const char* field : {"format", "version", "package"}) {
    if (!document.has(field)) throw InputError({file.string(), field, "", "no such field", kCure});
  }
  const io::JsonField format = document["format"];
  if (format.text() != "facezip-gains") format.fail("\"facezip-gains\"", format.got(), kCure);
  document["version"].integer(1, 1);
  const io::JsonField name = document["package"];
  if (name.text() != package.name()) {
    name.fail(fmt::format("{}, the package's name", io::quoted(package.name())), name.got(),
              "gains belong to the package they were tuned on: make the preset with this one");
  }
}

/// Sets the gains of the names that `field` holds.
void readFactors(const io::JsonField& field, const std::vector<std::string>& names, const char* what,
                 std::vector<float>& gains) {
  for (const auto& [name, value] : field.object().items()) {
    const auto found = std::ranges::find(names, io::composed(name));
    if (found == names.end()) {
      field.fail(fmt::format("{}s of the package ({})", what, fmt::join(names, ", ")), io::quoted(name));
    }
    gains[toSize(found - names.begin())] = static_cast<float>(field[name].number(0.0, kLargestGain));
  }
}

/// 1 + sum over regions of (gain - 1) R, on the cells of the masks.
std::vector<float> gainOfMaskCells(const Package& package, const std::vector<float>& regions) {
  const PackageMasks& masks = *package.description().masks;
  const image::Image picture =
      image::readImage(package::openImage(package.folder(), masks.file, package::masksShape(masks)));
  std::vector<float> gain(toSize(masks.tile_width * masks.tile_height), 1.0f);
  for (std::size_t r = 0; r < regions.size(); ++r) {
    if (regions[r] == 1.0f) continue;
    for (const int k : package.description().regions[r].masks) {
      for (int y = 0; y < masks.tile_height; ++y) {
        for (int x = 0; x < masks.tile_width; ++x) {
          const int row = k / masks.columns * masks.tile_height + y;
          const int column = k % masks.columns * masks.tile_width + x;
          const auto code = picture.samples[toSize(row * picture.shape.width + column)];
          gain[toSize(y * masks.tile_width + x)] +=
              (regions[r] - 1.0f) * static_cast<float>(std::to_integer<int>(code)) / 255.0f;
        }
      }
    }
  }
  return gain;
}

/// Bilinear, where a set has another number of cells than the masks; exact where it has the same.
std::vector<float> resample(const std::vector<float>& gain, const PackageMasks& masks, const PackageWeights& set) {
  const auto position = [](int cell, int cells, int mask_cells) {
    const float at = (static_cast<float>(cell) + 0.5f) * static_cast<float>(mask_cells) / static_cast<float>(cells);
    return std::clamp(at - 0.5f, 0.0f, static_cast<float>(mask_cells - 1));
  };
  const auto at = [&](int x, int y) {
    return gain[toSize(std::min(y, masks.tile_height - 1) * masks.tile_width + std::min(x, masks.tile_width - 1))];
  };
  std::vector<float> cells;
  for (int y = 0; y < set.tile_height; ++y) {
    const float v = position(y, set.tile_height, masks.tile_height);
    const int row = static_cast<int>(v);
    for (int x = 0; x < set.tile_width; ++x) {
      const float u = position(x, set.tile_width, masks.tile_width);
      const int column = static_cast<int>(u);
      const float above = std::lerp(at(column, row), at(column + 1, row), u - static_cast<float>(column));
      const float below = std::lerp(at(column, row + 1), at(column + 1, row + 1), u - static_cast<float>(column));
      cells.push_back(std::lerp(above, below, v - static_cast<float>(row)));
    }
  }
  return cells;
}

}  // namespace

Gain unitGain(const Package& package) {
  Gain gain;
  gain.expressions.assign(package.expressions().size(), 1.0f);
  gain.regions.assign(package.description().regions.size(), 1.0f);
  gain.cells.resize(package.weightSets().size());
  return gain;
}

void applyRegions(const Package& package, Gain& gain) {
  gain.cells.assign(package.weightSets().size(), {});
  if (std::ranges::all_of(gain.regions, [](float factor) { return factor == 1.0f; })) return;
  const std::vector<float> cells = gainOfMaskCells(package, gain.regions);
  for (std::size_t set = 0; set < gain.cells.size(); ++set) {
    gain.cells[set] = resample(cells, *package.description().masks, package.weightSets()[set]);
  }
}

Gain readGain(const fs::path& file, const Package& package) {
  const nlohmann::json json =
      io::parseJson(io::readFile(file, "a preset that `facezip view` saved", "", kLargestFile), file.string());
  const io::JsonField document(json, file.string(), "");
  requirePresetOf(document, package, file);
  Gain gain = unitGain(package);
  if (document.has("expressions")) {
    readFactors(document["expressions"], package.expressions(), "expression", gain.expressions);
  }
  std::vector<std::string> regions;
  for (const PackageRegion& region : package.description().regions) regions.push_back(region.name);
  if (document.has("regions")) readFactors(document["regions"], regions, "region", gain.regions);
  applyRegions(package, gain);
  return gain;
}

}  // namespace facezip
