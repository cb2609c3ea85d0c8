#include "compress/memory_plan.hpp"

#include <algorithm>
#include <array>
#include <set>

#include "bands/map_bands.hpp"
#include "blocks/block_format.hpp"
#include "codes/coded_textures.hpp"
#include "compress/band_plan.hpp"
#include "refine/refinement.hpp"

namespace facezip::compress {

/// What stays from pass to pass: weights of every set as codes, at the start and as written, one as halves while it
/// is refined, the masks of the cells, the Gram matrices, the classes of the texels of each raster, and neutrals that
/// are coded.
std::uint64_t MemoryPlan::residentBytes(const PackageForm& form) const {
  const WeightSpace space = weightSpace(maps_, form);
  constexpr std::uint64_t kMasksOfACell = 8;
  const std::uint64_t cells = static_cast<std::uint64_t>(space.columns) * static_cast<std::uint64_t>(space.rows);
  std::set<const raster::TexelClasses*> classes;
  std::uint64_t class_bytes = 0;
  for (const OpenMap& map : maps_.maps) {
    if (classes.insert(map.classes.get()).second) class_bytes += map.classes->bytes();
  }
  std::uint64_t neutral_bytes = 0;
  for (const OpenMap& map : maps_.maps) {
    const image::ImageShape& shape = map.samples->shape();
    if (!form.blocks || shape.type != image::SampleType::kUint8) continue;
    neutral_bytes +=
        blocks::blockBytes(blocks::formatFor(form.blocks->neutral, shape.channels), shape.width, shape.height);
  }
  const auto weights = static_cast<std::uint64_t>(space.expressions) * static_cast<std::uint64_t>(space.textures);
  const std::uint64_t weight_sets = form.weights_per_map ? maps_.maps.size() : 1;
  const std::uint64_t summed = gram_sets_ > weight_sets ? 1 : 0;  // those of all maps together beside those of each
  return class_bytes + neutral_bytes + slots_.bytes(space.expressions) * (gram_sets_ + summed) +
         cells * (weights * (2 * weight_sets + 2) + kMasksOfACell * (sizeof(int) + sizeof(float)) + sizeof(int));
}

namespace {

/// Rows of texels that whole blocks of all textures fill; 0 without blocks.
int blockRows(const PackageForm& form) {
  if (!form.blocks) return 0;
  return blockRowStep(std::array{form.blocks->neutral, form.blocks->differences});
}

}  // namespace

int MemoryPlan::bandRows(const PackageForm& form) const {
  const std::uint64_t resident = residentBytes(form);
  int rows = 0;
  for (const OpenMap& map : maps_.maps) {
    BandShape shape = bandShape(*map.samples, 0);
    shape.neutral_decoded = form.blocks && map.samples->shape().type == image::SampleType::kUint8;
    BandCost cost = bandCost(shape, form.differences, slots_.masks);
    cost.row_step = std::max(kTileSide, blockRows(form));  // of all maps, which have bands of the same rows
    const int planned =
        planBandRows(cost, map.samples->shape().height, run_.memory_bytes, resident, run_.context.info());
    rows = rows == 0 ? planned : std::min(rows, planned);
  }
  return rows;
}

int MemoryPlan::windowRows(const PackageForm& form, std::span<const GridMap> group) const {
  const WeightSpace space = weightSpace(maps_, form);
  return planWindowRows(group, space, {sweepsHalfCells(run_.context, group), blockRows(form)}, run_.memory_bytes,
                        residentBytes(form), run_.context.info());
}

}  // namespace facezip::compress
