// map_evaluation.hpp - all that an evaluation finds on one map, in one pass over its textures (two with pictures of
// PCA).
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "bands/map_bands.hpp"
#include "evaluate/candidates.hpp"
#include "evaluate/subject.hpp"
#include "facezip/evaluate.hpp"

namespace facezip::evaluate {

struct MapEvaluation {
  Evaluation::Map map;
  std::uint64_t covered_texels = 0;
  std::optional<ErrorPictures> pictures;
};

/// Measures every candidate, PCA and the limit on map `index` of the package.
/// blend_weights  of the random blends
/// Throws InputError for damaged packages and textures, DeviceError, Cancelled.
MapEvaluation evaluateMap(const compress::OpenMap& map, int index, const Candidates& candidates, const Subject& subject,
                          const EvaluateOptions& options, const std::vector<std::vector<float>>& blend_weights,
                          compress::BandBuffers& buffers);

}  // namespace facezip::evaluate
