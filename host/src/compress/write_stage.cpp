#include "compress/write_stage.hpp"

#include <fmt/format.h>

#include "blocks/block_format.hpp"
#include "compress/package_output.hpp"

namespace facezip::compress {
namespace {

int bitsOf(const PackageForm& form, const WeightSpace& space, const GridMap& map, std::size_t m,
           const FittedWeights& fitted, const CoveredFace& face) {
  // Frames of 8 bits round by more than the codes of their differences do.
  if (map.map->samples->shape().type == SampleType::kUint8) return 8;
  if (form.code_bits) return *form.code_bits;  // chosen for the size: it is kept to
  if (fitted.errors.empty()) return 8;
  const double code_error = codeSquaredError(fitted.ranges[m], meanSquares(fitted.weights, space, face.cells)) *
                            static_cast<double>(face.texels[map.index]) * space.expressions;
  return codeBits(code_error, fitted.errors[m]);
}

}  // namespace

bool inBlocks(const PackageForm& form, const GridMap& map) {
  return form.blocks && map.map->samples->shape().type == SampleType::kUint8;
}

std::vector<MapCodes> codesOf(const PackageForm& form, const WeightSpace& space, std::span<const GridMap> group,
                              const FittedWeights& fitted, const CoveredFace& face) {
  std::vector<MapCodes> codes;
  for (std::size_t m = 0; m < group.size(); ++m) {
    if (inBlocks(form, group[m])) {
      const BlockFormat format = blocks::formatFor(form.blocks->differences, group[m].map->samples->shape().channels);
      codes.push_back(codesOfBlocks(fitted.ranges[m], format, form.differences));
    } else {
      codes.push_back(codesOfBits(fitted.ranges[m], bitsOf(form, space, group[m], m, fitted, face)));
    }
  }
  return codes;
}

double writtenError(const PackageForm& form, const WeightSpace& space, std::span<const GridMap> group,
                    const FittedWeights& fitted, const CoveredFace& face, int band_rows, const device::Run& run) {
  const std::vector<MapCodes> codes = codesOf(form, space, group, fitted, face);
  BandBuffers buffers(run.context);
  double error = 0.0;
  for (std::size_t m = 0; m < group.size(); ++m) {
    const OpenMap& map = *group[m].map;
    FittedTextures textures(run.context, space, fitted.weights, codes[m]);
    const auto make_tiles = [&](int begin, int end) { return textures.tiles(map, begin, end); };
    forEachMapBand(*map.samples, band_rows, buffers, make_tiles, fmt::format("comparing: {}", map.source->name),
                   run.progress, [&](const MapBand& band) { textures.compute(group[m], band); });
    error += group[m].fit_weight * textures.squaredError();
  }
  run.clock.book("comparing");
  return error;
}

std::vector<std::optional<double>> writePackage(const PackageContent& content, const std::filesystem::path& directory,
                                                int band_rows, const device::Run& run) {
  PackageSolution solution{content.capture, content.form.differences, {}, {}, content.method_json, content.has_mesh,
                           content.guides};
  solution.maps.resize(content.face.texels.size());
  std::vector<const MeasuredTextures*> measured(solution.maps.size(), nullptr);
  for (std::size_t g = 0; g < content.groups.size(); ++g) {
    const std::vector<GridMap>& group = content.groups[g];
    const FittedWeights& fitted = content.fitted[g];
    solution.weights.push_back(&fitted.weights);
    std::vector<MapCodes> codes = codesOf(content.form, content.space, group, fitted, content.face);
    for (std::size_t m = 0; m < group.size(); ++m) {
      MapSolution& map = solution.maps[group[m].index];
      map.map = group[m];
      map.weight_set = static_cast<int>(g);
      map.codes = std::move(codes[m]);
      if (inBlocks(content.form, group[m])) {
        map.neutral = &*fitted.neutrals[m];
        map.block_textures = std::make_unique<BlockTextures>(run.context, content.space, fitted.weights, map.codes,
                                                             group[m].map->samples->shape().channels);
        measured[group[m].index] = map.block_textures.get();
      } else if (content.direct_textures) {
        map.textures = content.direct_textures(g);
      } else {
        auto textures = std::make_unique<FittedTextures>(run.context, content.space, fitted.weights, map.codes);
        measured[group[m].index] = textures.get();
        map.textures = std::move(textures);
      }
    }
  }
  writePackageFiles(solution, directory, band_rows, run);
  std::vector<std::optional<double>> errors;
  for (const MeasuredTextures* textures : measured) {
    errors.push_back(textures == nullptr ? std::nullopt : std::optional(textures->squaredError()));
  }
  run.clock.book("writing");
  return errors;
}

}  // namespace facezip::compress
