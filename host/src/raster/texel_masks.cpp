#include "raster/texel_masks.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cstdint>
#include <set>
#include <utility>

#include "io/counts.hpp"

namespace facezip::raster {
namespace {

/// Appends the tiles of `part` to `whole`.
void append(TileMasks& whole, const TileMasks& part) {
  const int offset = static_cast<int>(whole.mask_index.size());
  whole.tiles.insert(whole.tiles.end(), part.tiles.begin(), part.tiles.end());
  for (std::size_t t = 1; t < part.mask_begin.size(); ++t) whole.mask_begin.push_back(offset + part.mask_begin[t]);
  whole.mask_index.insert(whole.mask_index.end(), part.mask_index.begin(), part.mask_index.end());
  whole.mask_weights.insert(whole.mask_weights.end(), part.mask_weights.begin(), part.mask_weights.end());
  whole.texel_weights.insert(whole.texel_weights.end(), part.texel_weights.begin(), part.texel_weights.end());
  whole.fades.insert(whole.fades.end(), part.fades.begin(), part.fades.end());
}

float fadeOf(std::uint8_t fade) { return static_cast<float>(fade) * (1.0f / 255.0f); }

/// The fades of a tile of rows [begin, end).
void appendFades(const TexelClasses& classes, TilePosition tile, int begin, int end, std::vector<float>& fades) {
  for (int t = 0; t < kTileTexels; ++t) {
    const int x = tile.x * kTileSide + t % kTileSide;
    const int y = begin + tile.y * kTileSide + t / kTileSide;
    fades.push_back(x < classes.width() && y < end ? fadeOf(classes.fade(x, y)) : 1.0f);
  }
}

/// 1 for each bit of 16 that is set, else 0.
void spread(std::uint32_t bits, float* values) {
  for (int x = 0; x < kTileSide; ++x) values[x] = static_cast<float>(bits >> x & 1u);
}

/// Calls visit(tile, active, covered) for every tile of one row of tiles with the 256 values of each: 1 where a texel
/// has a triangle of the region (its own, or its neighbour's in the gutter), and where it is covered.
template <typename Visit>
void forEachTile(const TexelClasses& classes, int begin, int end, int tile_y, const Visit& visit) {
  const int first = begin + tile_y * kTileSide;
  const int rows = std::min(kTileSide, end - first);
  for (int tile_x = 0; tile_x * kTileSide < classes.width(); ++tile_x) {
    std::uint32_t any = 0;
    for (int y = 0; y < rows; ++y) any |= classes.active(tile_x, first + y);
    if (any == 0) continue;
    std::array<float, kTileTexels> active{};
    std::array<float, kTileTexels> covered{};
    for (int y = 0; y < rows; ++y) {
      spread(classes.active(tile_x, first + y), active.data() + y * kTileSide);
      spread(classes.covered(tile_x, first + y), covered.data() + y * kTileSide);
    }
    visit(TilePosition{tile_x, tile_y}, active, covered);
  }
}

/// Cuts samples into tiles, a row of tiles at a time on several threads: fill(row of tiles, tiles to append to).
template <typename Fill>
TileMasks tilesByRows(int rows, const Fill& fill) {
  std::vector<TileMasks> parts(toSize(tilesAlong(rows)));
  tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t y) {
    parts[y].mask_begin.push_back(0);
    fill(static_cast<int>(y), parts[y]);
  });
  TileMasks whole;
  whole.mask_begin.push_back(0);
  for (const TileMasks& part : parts) append(whole, part);
  return whole;
}

}  // namespace

TexelMasks::TexelMasks(const geometry::TriangleMesh& mesh, const geometry::RegionMesh& region,
                       const geometry::MaskWeights& masks)
    : mesh_(mesh), region_(region), masks_(masks) {
  assert(masks.vertexCount() == region.vertexCount());
}

TexelMasks::Cursor::Cursor(const TexelMasks& masks) : masks_(masks), place_(toSize(masks.maskCount()), -1) {}

void TexelMasks::Cursor::moveTo(int triangle) {
  triangle_ = triangle;
  for (const Corners& old : corners_) place_[toSize(old.mask)] = -1;
  corners_.clear();
  const geometry::MaskWeights& masks = masks_.masks_;
  for (int corner = 0; corner < 3; ++corner) {
    const auto mesh_vertex = toSize(masks_.mesh_.triangles(triangle, corner));
    const auto vertex = toSize(masks_.region_.region_vertices[mesh_vertex]);
    for (int e = masks.row_begin[vertex]; e < masks.row_begin[vertex + 1]; ++e) {
      const int mask = masks.mask_index[toSize(e)];
      int& place = place_[toSize(mask)];
      if (place < 0) {
        place = static_cast<int>(corners_.size());
        corners_.push_back({mask, {}});
      }
      corners_[toSize(place)].weights[toSize(corner)] = masks.weight[toSize(e)];
    }
  }
}

void TexelMasks::addTile(const std::vector<TexelSample>& samples, int width, int rows, TilePosition position,
                         Cursor& cursor, std::vector<float>& scratch, bool fades, TileMasks& out) const {
  const int x_end = std::min(width, (position.x + 1) * kTileSide);
  const int y_end = std::min(rows, (position.y + 1) * kTileSide);
  // scratch holds [mask][256] for every mask and is all zero between calls.
  std::vector<int> active;
  std::vector<char> is_active(toSize(masks_.mask_count), 0);
  std::array<float, kTileTexels> texel_weights{};
  std::array<float, kTileTexels> fade;
  fade.fill(1.0f);
  for (int y = position.y * kTileSide; y < y_end; ++y) {
    for (int x = position.x * kTileSide; x < x_end; ++x) {
      const TexelSample& sample = samples[toSize(y, width) + toSize(x)];
      if (sample.triangle < 0) continue;
      const auto t = toSize((y - position.y * kTileSide) * kTileSide + (x - position.x * kTileSide));
      if (sample.kind == TexelSample::Kind::kCovered) texel_weights[t] = 1.0f;
      fade[t] = fadeOf(sample.fade);
      for (const Corners& corners : cursor.at(sample.triangle)) {
        const auto mask = toSize(corners.mask);
        const float value = corners.at(sample);
        scratch[mask * kTileTexels + t] = value;
        if (value > 0.0f && !is_active[mask]) {
          is_active[mask] = 1;
          active.push_back(corners.mask);
        }
      }
    }
  }
  if (active.empty()) return;
  std::sort(active.begin(), active.end());
  out.tiles.push_back(position);
  for (const int mask : active) {
    const auto values = scratch.begin() + static_cast<std::ptrdiff_t>(mask) * kTileTexels;
    out.mask_index.push_back(mask);
    out.mask_weights.insert(out.mask_weights.end(), values, values + kTileTexels);
    std::fill(values, values + kTileTexels, 0.0f);
  }
  out.mask_begin.push_back(static_cast<int>(out.mask_index.size()));
  out.texel_weights.insert(out.texel_weights.end(), texel_weights.begin(), texel_weights.end());
  if (fades) out.fades.insert(out.fades.end(), fade.begin(), fade.end());
}

TileMasks TexelMasks::tiles(const UvRaster& raster, int begin, int end, Texels texels) const {
  const std::vector<TexelSample> samples =
      texels == Texels::kCovered ? raster.coveredRows(begin, end) : raster.rows(begin, end);
  const int tile_columns = tilesAlong(raster.width());
  const bool fades = texels == Texels::kCoveredAndGutter && raster.feather() > 0;
  return tilesByRows(end - begin, [&](int y, TileMasks& out) {
    Cursor cursor(*this);
    std::vector<float> scratch(toSize(masks_.mask_count) * kTileTexels, 0.0f);
    for (int x = 0; x < tile_columns; ++x) {
      addTile(samples, raster.width(), end - begin, {x, y}, cursor, scratch, fades, out);
    }
  });
}

std::vector<MaskPair> TexelMasks::overlappingPairs() const {
  std::set<std::pair<int, int>> pairs;
  std::vector<int> active;
  for (const auto& triangle : region_.triangles.rowwise()) {
    active.clear();
    for (const int vertex : triangle) {
      const auto entries = masks_.mask_index.begin();
      active.insert(active.end(), entries + masks_.row_begin[toSize(vertex)],
                    entries + masks_.row_begin[toSize(vertex) + 1]);
    }
    std::sort(active.begin(), active.end());
    active.erase(std::unique(active.begin(), active.end()), active.end());
    for (std::size_t a = 0; a < active.size(); ++a) {
      for (std::size_t b = a + 1; b < active.size(); ++b) pairs.emplace(active[a], active[b]);
    }
  }
  std::vector<MaskPair> result;
  for (const auto& [k, l] : pairs) result.push_back({k, l});
  return result;
}

TileMasks coverageTiles(const UvRaster& raster, int begin, int end) {
  const TexelClasses classes = TexelClasses::coveredRows(raster, begin, end);
  return tilesByRows(end - begin, [&](int tile_y, TileMasks& out) {
    forEachTile(classes, 0, end - begin, tile_y, [&](TilePosition tile, const auto&, const auto& covered) {
      out.tiles.push_back(tile);
      out.mask_begin.push_back(0);
      out.texel_weights.insert(out.texel_weights.end(), covered.begin(), covered.end());
    });
  });
}

TileMasks activeTiles(const TexelClasses& classes, int begin, int end) {
  return tilesByRows(end - begin, [&](int tile_y, TileMasks& out) {
    forEachTile(classes, begin, end, tile_y, [&](TilePosition tile, const auto& active, const auto& covered) {
      out.tiles.push_back(tile);
      out.mask_index.push_back(0);
      out.mask_weights.insert(out.mask_weights.end(), active.begin(), active.end());
      out.mask_begin.push_back(static_cast<int>(out.mask_index.size()));
      out.texel_weights.insert(out.texel_weights.end(), covered.begin(), covered.end());
      if (classes.fades()) appendFades(classes, tile, begin, end, out.fades);
    });
  });
}

}  // namespace facezip::raster
