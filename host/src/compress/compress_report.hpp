// compress_report.hpp - what a compression did, put together from what its stages returned.
#pragma once

#include "compress/attempt.hpp"
#include "compress/open_textures.hpp"
#include "facezip/compress.hpp"
#include "rate/rate_search.hpp"

namespace facezip::compress {

/// rates  the search of a target or budget; null without one. The clock, disk bytes and memory are the caller's to add.
CompressReport makeReport(const CompressionJob& job, const OpenTextures& textures, const GramSlots& slots,
                          const RateSearch* rates, const Attempt& attempt);

/// RMSE of all maps as written, in 1/255, by their metric weights. Textures of every map were fitted.
double pooledRmse(const CompressionJob& job, const Attempt& attempt);

}  // namespace facezip::compress
