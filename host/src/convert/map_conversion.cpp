#include "convert/map_conversion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "blocks/block_format.hpp"
#include "codes/coded_refinement.hpp"
#include "compress/block_stage.hpp"
#include "convert/package_frames.hpp"
#include "convert/shown_texels.hpp"
#include "package/package_files.hpp"
#include "package/package_textures.hpp"
#include "package/weight_atlas.hpp"

namespace facezip::convert {
namespace {
using namespace compress;

constexpr int kMostWeightScale = 64;  ///< of CompressOptions

void requireWeightScale(const Package& package, const PackageMap& map) {
  if (map.weight_scale <= kMostWeightScale) return;
  throw InputError({package.directory().string(), fmt::format("map {}: weight_scale", map.name),
                    fmt::format("at most {}, as `facezip compress` writes", kMostWeightScale),
                    std::to_string(map.weight_scale), "convert a package with finer weights"});
}

/// How far the difference textures of a map reach: as far as their codes.
std::vector<TextureRange> rangesOf(const PackageMap& map) {
  const double codes = map.difference_bits == 16 ? 65535.0 : 255.0;
  std::vector<TextureRange> ranges;
  for (const PackageDifference& difference : map.differences) {
    for (std::size_t c = 0; c < difference.scale.size(); ++c) {
      ranges.push_back({static_cast<float>(difference.offset[c]),
                        static_cast<float>(difference.offset[c] + codes * difference.scale[c])});
    }
  }
  return ranges;
}

/// The neutral as it is stored, for the encoder: bytes where it has whole codes.
class StoredNeutral {
 public:
  StoredNeutral(const Package& package, const PackageMap& map)
      : reader_(package.folder(), package::neutralTexture(map)) {}

  decltype(blocks::TexelRows::samples) rows(int begin, int end) {
    const image::ImageShape& shape = reader_.shape();
    bytes_.resize(toSize(end - begin) * shape.rowBytes());
    reader_.readRows(begin, end, bytes_);
    if (shape.type == SampleType::kUint8) {
      return std::span(reinterpret_cast<const std::uint8_t*>(bytes_.data()), bytes_.size());
    }
    codes_.resize(bytes_.size() / 2);
    for (std::size_t s = 0; s < codes_.size(); ++s) {
      std::uint16_t sample = 0;
      std::memcpy(&sample, &bytes_[2 * s], sizeof(sample));
      codes_[s] = static_cast<float>(sample) / 257.0f;
    }
    return std::span<const float>(codes_);
  }

 private:
  package::TextureReader reader_;
  std::vector<std::byte> bytes_;
  std::vector<float> codes_;
};

/// Opens the maps: their frames, and which texels of them change.
void openSet(const Conversion& conversion, int set, ConvertedSet& converted) {
  const Package& package = conversion.package;
  for (std::size_t m = 0; m < package.maps().size(); ++m) {
    const PackageMap& map = package.maps()[m];
    if (map.weight_set != set || !fitsBlocks(map)) continue;
    requireWeightScale(package, map);
    converted.indices.push_back(static_cast<int>(m));
    converted.sources.emplace_back().name = map.name;
  }
  double most_weight = 0.0;
  for (const int index : converted.indices) {
    most_weight = std::max(most_weight, package.maps()[toSize(index)].metric_weight);
  }
  for (std::size_t i = 0; i < converted.indices.size(); ++i) {
    const int index = converted.indices[i];
    const PackageMap& map = package.maps()[toSize(index)];
    OpenMap& open = converted.maps.maps.emplace_back();
    open.source = &converted.sources[i];
    open.metric_weight = most_weight > 0.0 ? map.metric_weight : 1.0;
    open.samples = std::make_unique<image::SampleBands>(
        package::neutralShape(map), SampleType::kFloat32, converted.space.expressions,
        std::make_unique<PackageFrames>(package, index, conversion.weights, conversion.device));
    const ShownTexels shown =
        findShownTexels(package, index, conversion.mesh, converted.weights, converted.space, conversion.run.progress);
    open.classes = shown.classes;
    converted.energy += open.metric_weight * shown.energy;
    converted.cells.resize(shown.cells.size(), 0);
    for (std::size_t q = 0; q < shown.cells.size(); ++q) converted.cells[q] |= shown.cells[q];
    const auto size = [&](std::size_t m) { return package.maps()[toSize(converted.indices[m])].frameBytes(); };
    if (size(i) > size(converted.maps.reference)) converted.maps.reference = i;
  }
  for (std::size_t i = 0; i < converted.indices.size(); ++i) {
    OpenMap& open = converted.maps.maps[i];
    converted.group.push_back(
        {&open, i, open.metric_weight, package.maps()[toSize(converted.indices[i])].weight_scale});
  }
}

void codeNeutrals(const Conversion& conversion, ConvertedSet& converted) {
  for (std::size_t i = 0; i < converted.indices.size(); ++i) {
    const PackageMap& map = conversion.package.maps()[toSize(converted.indices[i])];
    StoredNeutral stored(conversion.package, map);
    const auto read = [&](int begin, int end) { return stored.rows(begin, end); };
    converted.neutrals.push_back(codeNeutral(conversion.run.context, package::neutralShape(map),
                                             *converted.maps.maps[i].classes, read,
                                             blocks::formatFor(conversion.formats.neutral, map.channels),
                                             blocks::Quality::kNormal, map.name, conversion.run.progress));
    converted.codes.push_back(codesOfBlocks(
        rangesOf(map), blocks::formatFor(conversion.formats.differences, map.channels), converted.space.textures));
  }
}

bool refits(const Conversion& conversion, int set) {
  return conversion.refits_weights && std::ranges::all_of(conversion.package.maps(), [set](const PackageMap& map) {
           return map.weight_set != set || fitsBlocks(map);
         });
}

}  // namespace

std::uint64_t ConvertedSet::neutralBytes() const {
  std::uint64_t bytes = 0;
  for (const CodedNeutral& neutral : neutrals) bytes += neutral.blocks.size();
  return bytes;
}

WeightSpace spaceOf(const Package& package, int set) {
  const PackageWeights& weights = package.weightSets()[toSize(set)];
  WeightSpace space;
  space.columns = weights.tile_width;
  space.rows = weights.tile_height;
  space.textures = package.differences();
  space.expressions = static_cast<int>(package.expressions().size());
  return space;
}

EncodedWeights readWeights(const Package& package, int set) {
  const PackageWeights& stored = package.weightSets()[toSize(set)];
  EncodedWeights weights{stored.scale, stored.offset, {}};
  weights.codes.resize(package.expressions().size() * toSize(stored.tile_height, stored.tile_width) *
                       toSize(package.differences()));
  package::readWeightCodes(package.description(), set, package.folder(),
                           std::as_writable_bytes(std::span(weights.codes)));
  return weights;
}

std::unique_ptr<ConvertedSet> convertSet(const Conversion& conversion, int set, std::uint64_t kept_bytes) {
  auto converted = std::make_unique<ConvertedSet>();
  converted->weights = readWeights(conversion.package, set);
  converted->space = spaceOf(conversion.package, set);
  openSet(conversion, set, *converted);
  if (converted->indices.empty()) return converted;
  conversion.run.clock.book("looking for texels that change");

  const device::Run run{conversion.run.context, conversion.run.progress, conversion.run.clock,
                        conversion.run.memory_bytes - std::min(conversion.run.memory_bytes, kept_bytes)};
  const PackageForm form{converted->space.textures, converted->group[converted->maps.reference].weight_scale,
                         std::nullopt, conversion.formats};
  const GramSlots no_grams;
  const MemoryPlan memory(converted->maps, no_grams, 1, run);
  converted->band_rows = memory.bandRows(form);
  const int window_rows = memory.windowRows(form, converted->group);
  codeNeutrals(conversion, *converted);
  run.clock.book("coding neutrals");
  if (!refits(conversion, set)) return converted;

  const std::optional<Importance> none;  // a package does not tell what its capture's was
  const FitProblem problem{converted->space,   converted->group,
                           converted->weights, converted->energy,
                           converted->cells,   none,
                           window_rows,        true};
  std::vector<CodedMap> maps;
  for (std::size_t i = 0; i < converted->group.size(); ++i) {
    maps.push_back({converted->group[i],
                    {converted->codes[i].formats, converted->codes[i].encoding, converted->neutrals[i].channels},
                    &converted->neutrals[i]});
  }
  converted->weights = refitWeights(problem, converted->weights, maps, run);
  return converted;
}

}  // namespace facezip::convert
