// synthetic_grams.hpp - Gram matrices of random fragments, for benchmarks of the search.
#pragma once

#include <algorithm>

#include "compress/search/counter_hash.hpp"
#include "compress/search/gram_matrices.hpp"

namespace facezip::bench {

/// N fragments of rank 32 in every slot; mask k overlaps the next `reach` masks, which makes about K * reach pairs.
inline compress::GramMatrices makeGrams(int expressions, int masks, int reach) {
  constexpr int kRank = 32;
  compress::GramMatrices grams;
  grams.expressions = expressions;
  grams.slots.masks = masks;
  for (int k = 0; k < masks; ++k) {
    for (int l = k + 1; l < std::min(masks, k + 1 + reach); ++l) grams.slots.pairs.push_back({k, l});
  }
  for (int slot = 0; slot < grams.slots.count(); ++slot) {
    compress::GramMatrices::Matrix fragments(expressions, kRank);
    for (int n = 0; n < expressions; ++n) {
      for (int i = 0; i < kRank; ++i) {
        const auto bits = compress::counterHash(1, static_cast<std::uint64_t>(slot), static_cast<std::uint64_t>(n),
                                                static_cast<std::uint64_t>(i));
        fragments(n, i) = static_cast<double>(bits >> 11) * 0x1p-52 - 1.0;
      }
    }
    const compress::GramMatrices::Matrix gram = fragments * fragments.transpose();
    grams.values.insert(grams.values.end(), gram.data(), gram.data() + gram.size());
  }
  return grams;
}

}  // namespace facezip::bench
