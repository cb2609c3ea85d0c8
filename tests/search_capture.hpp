// search_capture.hpp - a capture of a few texels in a row, for tests of the search on Gram matrices.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <random>
#include <utility>
#include <vector>

#include "search/gram_matrices.hpp"

namespace facezip::test {

using Vector = std::vector<double>;
using Vectors = std::vector<Vector>;

/// N differences and K masks over P texels of one channel.
struct SearchCapture {
  Vectors differences;  ///< N x P
  Vectors masks;        ///< K x P, columns sum to 1

  std::size_t texels() const { return masks.front().size(); }

  /// Delta_n M_k of every n (Eq. 2), on the texels where mask k is above zero.
  Vectors fragments(std::size_t k) const {
    Vectors result(differences.size());
    for (std::size_t n = 0; n < differences.size(); ++n) {
      for (std::size_t p = 0; p < texels(); ++p) {
        if (masks[k][p] > 0.0) result[n].push_back(differences[n][p] * masks[k][p]);
      }
    }
    return result;
  }
};

/// A double in [-1, 1), the same on every platform.
inline double uniform(std::mt19937_64& random) { return static_cast<double>(random() >> 11) * 0x1p-52 - 1.0; }

/// Masks that are hats over neighbouring stretches of texels: soft ones overlap their neighbours, hard ones are 0 or 1.
enum class Masks { kSoft, kHard };

/// Soft masks that reach over `reach` neighbours on either side, each K x P.
inline Vectors makeWideMasks(int masks, int texels_per_mask, int reach) {
  Vectors result(static_cast<std::size_t>(masks), Vector(static_cast<std::size_t>(masks * texels_per_mask), 0.0));
  for (std::size_t p = 0; p < result.front().size(); ++p) {
    const double place = (static_cast<double>(p) + 0.5) / texels_per_mask - 0.5;  // in masks; mask k is centred at k
    double sum = 0.0;
    for (int k = 0; k < masks; ++k) {
      double& weight = result[static_cast<std::size_t>(k)][p];
      weight = std::max(0.0, 1.0 - 2.0 * std::abs(place - k) / (reach + 1));
      sum += weight;
    }
    for (Vector& mask : result) mask[p] /= sum;
  }
  return result;
}

inline Vectors makeMasks(int masks, int texels_per_mask, Masks kind) {
  const int texels = masks * texels_per_mask;
  Vectors result(static_cast<std::size_t>(masks), Vector(static_cast<std::size_t>(texels), 0.0));
  for (int p = 0; p < texels; ++p) {
    const double place = (p + 0.5) / texels_per_mask - 0.5;  // in masks; mask k is centred at k
    const int left = place < 0.0 ? -1 : static_cast<int>(place);
    const double share = kind == Masks::kSoft ? place - left : (place - left < 0.5 ? 0.0 : 1.0);
    const auto add = [&](int k, double weight) {
      if (k < 0) k = 0;
      if (k >= masks) k = masks - 1;
      result[static_cast<std::size_t>(k)][static_cast<std::size_t>(p)] += weight;
    };
    add(left, 1.0 - share);
    add(left + 1, share);
  }
  return result;
}

inline SearchCapture randomCapture(int expressions, int masks, std::uint64_t seed, Masks kind = Masks::kSoft,
                                   int texels_per_mask = 8) {
  std::mt19937_64 random(seed);
  SearchCapture capture{{}, makeMasks(masks, texels_per_mask, kind)};
  for (int n = 0; n < expressions; ++n) {
    Vector difference(capture.texels());
    for (double& value : difference) value = 100.0 * uniform(random);
    capture.differences.push_back(difference);
  }
  return capture;
}

/// One whose masks overlap several others, as those of a face do.
inline SearchCapture wideCapture(int expressions, int masks, int reach, std::uint64_t seed) {
  SearchCapture capture = randomCapture(expressions, masks, seed, Masks::kSoft, /* texels_per_mask= */ 4);
  capture.masks = makeWideMasks(masks, 4, reach);
  return capture;
}

/// Gram matrices of the masks and of all pairs that overlap, by their definition.
inline compress::GramMatrices gramsOf(const SearchCapture& capture) {
  compress::GramMatrices grams;
  const std::size_t n_count = capture.differences.size(), masks = capture.masks.size(), texels = capture.texels();
  grams.expressions = static_cast<int>(n_count);
  grams.slots.masks = static_cast<int>(masks);
  const auto append = [&](const std::function<double(std::size_t)>& weight) {
    std::vector<std::pair<std::size_t, double>> squares;  // of the texels that count
    for (std::size_t p = 0; p < texels; ++p) {
      const double w = weight(p);
      if (w != 0.0) squares.emplace_back(p, w * w);
    }
    for (std::size_t n = 0; n < n_count; ++n) {
      for (std::size_t m = 0; m < n_count; ++m) {
        double sum = 0.0;
        for (const auto& [p, square] : squares) sum += square * capture.differences[n][p] * capture.differences[m][p];
        grams.values.push_back(sum);
      }
    }
  };
  append([](std::size_t) { return 1.0; });
  for (std::size_t k = 0; k < masks; ++k) append([&](std::size_t p) { return capture.masks[k][p]; });
  for (std::size_t k = 0; k < masks; ++k) {
    for (std::size_t l = k + 1; l < masks; ++l) {
      const auto both = [&](std::size_t p) { return capture.masks[k][p] * capture.masks[l][p]; };
      bool overlap = false;
      for (std::size_t p = 0; p < texels; ++p) overlap |= both(p) > 0.0;
      if (!overlap) continue;
      grams.slots.pairs.push_back({static_cast<int>(k), static_cast<int>(l)});
      append(both);
    }
  }
  return grams;
}

}  // namespace facezip::test
