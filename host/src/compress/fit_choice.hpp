// fit_choice.hpp - refined weights or the paper's, whichever errs less when rounded.
#pragma once

#include "compress/fit_stage.hpp"
#include "compress/package_form.hpp"
#include "compress/write_stage.hpp"

namespace facezip::compress {

/// Fits weights. Rounding can make them worse than the paper's with textures that suit those, but only where the
/// paper's are exact or nearly so: where that may be, both are measured as they would be written.
FittedWeights chooseFit(const FitProblem& problem, const PackageForm& form, const CoveredFace& face, int band_rows,
                        const device::Run& run);

}  // namespace facezip::compress
