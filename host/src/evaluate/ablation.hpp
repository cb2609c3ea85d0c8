// ablation.hpp - every method at several numbers of difference textures, each as a package that is made and decoded.
#pragma once

#include "evaluate/subject.hpp"
#include "facezip/evaluate.hpp"

namespace facezip::evaluate {

/// Adds the methods of compression at C = 1 to kMostAblated to Evaluation::Map::ablation and ablation_bytes, and the
/// bytes of "limit". Packages are made one after the other in the directory for temporary files and are gone when they
/// were measured; those that `evaluation` has measured already are not made again.
/// Throws what compressCapture() throws, InputError, DeviceError, Cancelled.
void addAblation(const Subject& subject, Evaluation& evaluation);

/// Adds a point of Evaluation::mask_sweep for every number of masks, by the package's method and the paper's.
void addMaskSweep(const Subject& subject, const std::vector<int>& masks, Evaluation& evaluation);

inline constexpr int kMostAblated = 4;

}  // namespace facezip::evaluate
