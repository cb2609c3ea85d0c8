#include "compress/attempt.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <utility>

#include "compress/block_stage.hpp"
#include "compress/compress_stretch.hpp"
#include "compress/fit_choice.hpp"
#include "compress/method_record.hpp"
#include "compress/write_stage.hpp"
#include "raster/grid_masks.hpp"

namespace facezip::compress {
namespace {
using MapGroups = std::vector<std::vector<GridMap>>;

raster::GridMasks layGrid(const CompressionJob& job, const PackageForm& form) {
  job.run.progress.stage("weight grid", 0);
  return raster::makeGridMasks(job.masks, *job.maps.maps[job.maps.reference].raster, form.weight_scale);
}

/// Weights of every group as the method starts from them.
std::vector<SearchedWeights> searchGroups(const CompressionJob& job, const PackageForm& form,
                                          std::span<const GramMatrices> all_grams, const CellMasks& cells) {
  std::vector<SearchedWeights> searched;
  for (const GramMatrices& grams : all_grams) {
    if (job.options.method == Method::kCompressStretch) {
      searched.push_back(influenceWeights(job.capture, job.model.face, *job.maps.maps[job.maps.reference].raster,
                                          form.weight_scale, job.run));
    } else {
      searched.push_back(searchWeights(grams, cells, job.options, form.differences, job.run));
    }
  }
  return searched;
}

bool fitsTextures(Method method) { return method == Method::kRefined || method == Method::kClosedLoop; }

/// Textures that follow from the weights of a group as they are: by clusters (FaceZip, Eq. 5) or influences.
std::unique_ptr<TextureSource> directTextures(const CompressionJob& job, const WeightSpace& space,
                                              const SearchedWeights& searched) {
  if (job.options.method == Method::kCompressStretch) {
    return std::make_unique<CompressStretchTextures>(job.run.context, space, searched.weights);
  }
  return std::make_unique<ClusterTextures>(job.run.context, job.masks, searched.coefficients);
}

std::vector<FittedWeights> fitGroups(const CompressionJob& job, const PackageForm& form, const WeightSpace& space,
                                     const MapGroups& groups, std::span<const GramMatrices> all_grams,
                                     const std::vector<SearchedWeights>& searched, const CoveredFace& face,
                                     int band_rows) {
  std::vector<FittedWeights> fitted;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    if (!fitsTextures(job.options.method)) {
      const auto textures = directTextures(job, space, searched[g]);
      fitted.push_back(keepWeights(searched[g].weights, groups[g], form.differences, *textures, band_rows, job.run));
      if (form.blocks) fitted.back().neutrals = codeNeutrals(form, groups[g], job.run);
      continue;
    }
    const GramMatrices& grams = all_grams[g];
    const FitProblem problem{space,
                             groups[g],
                             searched[g].weights,
                             grams.slot(grams.slots.whole()).trace(),
                             face.cells,
                             job.model.importance,
                             job.memory.windowRows(form, groups[g]),
                             form.blocks.has_value()};
    fitted.push_back(job.options.method == Method::kClosedLoop ? fitWeights(problem, 0, job.run)
                                                               : chooseFit(problem, form, face, band_rows, job.run));
    if (!form.blocks) continue;
    fitted.back().neutrals = codeNeutrals(form, groups[g], job.run);
    if (job.options.method != Method::kRefined) continue;
    fitted.back().weights = fitWeightsToBlocks(problem, form, fitted.back(), face, job.run);
  }
  return fitted;
}

MethodResult methodResult(const CompressionJob& job, double permutation_cost) {
  const FaceMasks& masks = job.model.masks;
  return {masks.masks.mask_count,
          masks.samples.radius,
          masks.unit ? geometry::unitSymbol(*masks.unit) : "",
          job.model.face.region_description,
          job.grams.covered_texels.front(),
          permutation_cost};
}

void noteSpareTextures(const WeightSpace& space, Progress& progress) {
  if (space.expressions > space.textures) return;
  progress.note(fmt::format("{} expression{}: each gets a difference texture of its own", space.expressions,
                            space.expressions == 1 ? "" : "s"));
}

}  // namespace

Attempt makePackage(const CompressionJob& job, const PackageForm& form, const std::filesystem::path& directory) {
  const WeightSpace space = weightSpace(job.maps, form);
  const MapGroups groups = groupMaps(job.maps, form.weights_per_map, form.weight_scale);
  const bool sums_grams = groups.size() < job.grams.grams.size();
  const std::optional<GramMatrices> sum = sums_grams ? std::optional(sumOf(job.grams, groups.front())) : std::nullopt;
  const std::span<const GramMatrices> grams = sum ? std::span(&*sum, 1) : std::span(job.grams.grams);
  const int band_rows = job.memory.bandRows(form);
  raster::GridMasks grid = layGrid(job, form);
  const MaskGuides guides = makeMaskGuides(job.model.face, job.model.masks, grid);
  job.run.clock.book("weight grid");
  noteSpareTextures(space, job.run.progress);

  // Masks of the cells are not needed any more once there are weights: their memory is the fit's.
  const std::vector<SearchedWeights> searched = searchGroups(job, form, grams, std::exchange(grid.cells, {}));
  const CoveredFace face{grid.covered, job.grams.covered_texels};
  const std::vector<FittedWeights> fitted = fitGroups(job, form, space, groups, grams, searched, face, band_rows);

  const PermutationRecord& permutation = searched.back().permutation;
  PackageContent content{job.capture,
                         form,
                         space,
                         groups,
                         fitted,
                         face,
                         methodJson(job.options, form, methodResult(job, permutation.cost)),
                         job.options.mesh,
                         guides,
                         {}};
  if (!fitsTextures(job.options.method)) {
    content.direct_textures = [&](std::size_t group) { return directTextures(job, space, searched[group]); };
  }
  std::vector<std::optional<double>> errors = writePackage(content, directory, band_rows, job.run);
  return {form, permutation, fitted.back().sweep_errors, std::move(errors), band_rows};
}

bool fitsMemory(const CompressionJob& job, const PackageForm& form) {
  try {
    job.memory.bandRows(form);
    for (const auto& group : groupMaps(job.maps, form.weights_per_map, form.weight_scale)) {
      job.memory.windowRows(form, group);
    }
    return true;
  } catch (const InputError&) {
    return false;
  } catch (const DeviceError&) {
    return false;
  }
}

}  // namespace facezip::compress
