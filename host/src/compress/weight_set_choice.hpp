// weight_set_choice.hpp - one set of weights for all maps, or one for each: what errs less by the byte.
#pragma once

#include <optional>

#include "compress/attempt.hpp"
#include "rate/rate_estimate.hpp"

namespace facezip::compress {

/// What the choice is estimated by, to be shown the texels of pass 1; none where there is nothing to choose.
/// options  of a package whose form is fixed; must outlive the estimate
std::optional<RateEstimate> estimateWeightSets(const CompressOptions& options, const MapSet& maps);

/// `form` with the sets of weights that the estimate speaks for, where --memory holds them. Notes what was chosen.
PackageForm chooseWeightSets(const RateEstimate& estimate, const CompressionJob& job, PackageForm form);

}  // namespace facezip::compress
