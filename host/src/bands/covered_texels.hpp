// covered_texels.hpp - the texels of a band that count, and samples as values in one unit.
#pragma once

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "bands/tile_band.hpp"

namespace facezip::compress {

/// The texels of weight above 0, each once whatever its weight, as row * width + column of the band, rising.
/// covered  the band's tiles
std::vector<std::uint32_t> coveredTexels(const BandShape& shape, const TileMasks& covered);

/// Samples as values in units of 1/255 of full scale. out  as many values as there are samples
void toValues(std::span<const std::byte> samples, image::SampleType type, std::span<float> out);

/// One image of a band: 0 the neutral, n + 1 expression n.
std::span<const std::byte> bandImage(std::span<const std::byte> samples, const BandShape& shape, int image);

/// Runs visit(begin, end) on chunks of [0, count), side by side. Chunks do not depend on the number of threads.
template <typename Visit>
void forEachChunk(std::size_t count, const Visit& visit) {
  constexpr std::size_t kChunk = 8192;
  tbb::parallel_for(std::size_t{0}, (count + kChunk - 1) / kChunk,
                    [&](std::size_t chunk) { visit(chunk * kChunk, std::min(count, (chunk + 1) * kChunk)); });
}

}  // namespace facezip::compress
