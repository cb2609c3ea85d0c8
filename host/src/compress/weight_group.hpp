// weight_group.hpp - maps that share weights, from their Gram matrices to what a package holds of them.
#pragma once

#include <vector>

#include "compress/bands/map_set.hpp"
#include "compress/codes/texture_encoding.hpp"
#include "compress/refine/grid_weights.hpp"
#include "compress/search/difference_texture.hpp"
#include "compress/search/gram_matrices.hpp"

namespace facezip::compress {

struct WeightGroup {
  std::vector<OpenMap*> maps;
  GramMatrices grams;
  TextureCoefficients coefficients;
  EncodedWeights start;                           ///< the paper's weights (Eq. 6)
  EncodedWeights weights;                         ///< that are written
  std::vector<std::vector<TextureRange>> ranges;  ///< of every map's difference textures
  std::vector<double> errors;                     ///< of every map: squared error before rounding, (1/255)^2
  double start_error = 0.0;                       ///< of all maps, with the start's weights, as the refinement saw it
};

}  // namespace facezip::compress
