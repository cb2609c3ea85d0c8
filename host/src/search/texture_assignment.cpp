#include "search/texture_assignment.hpp"

#include <cassert>

#include "io/counts.hpp"

namespace facezip::compress {

std::vector<float> differenceCoefficients(const Clustering& clustering, const Permutation& permutation) {
  assert(clustering.masks == permutation.masks && clustering.clusters == permutation.clusters);
  std::vector<float> coefficients;
  coefficients.reserve(clustering.labels.size() * toSize(clustering.clusters));
  for (int k = 0; k < clustering.masks; ++k) {
    std::vector<int> members(toSize(clustering.clusters), 0);
    for (int n = 0; n < clustering.expressions; ++n) ++members[toSize(clustering.label(k, n))];
    for (int i = 0; i < clustering.clusters; ++i) {
      const int cluster = permutation.cluster(k, i);
      const float share = 1.0f / static_cast<float>(members[toSize(cluster)]);  // unused when empty
      for (int n = 0; n < clustering.expressions; ++n) {
        coefficients.push_back(clustering.label(k, n) == cluster ? share : 0.0f);
      }
    }
  }
  return coefficients;
}

std::vector<int> textureOfExpression(const Clustering& clustering, const Permutation& permutation) {
  assert(clustering.masks == permutation.masks && clustering.clusters == permutation.clusters);
  std::vector<int> textures;
  textures.reserve(clustering.labels.size());
  std::vector<int> texture_of_cluster(toSize(clustering.clusters));
  for (int k = 0; k < clustering.masks; ++k) {
    for (int i = 0; i < clustering.clusters; ++i) {
      texture_of_cluster[toSize(permutation.cluster(k, i))] = i;
    }
    for (int n = 0; n < clustering.expressions; ++n) {
      textures.push_back(texture_of_cluster[toSize(clustering.label(k, n))]);
    }
  }
  return textures;
}

}  // namespace facezip::compress
