// tolerances.hpp - how far a result may lie from its reference, and why. One place, so that a loosened bound is seen.
#pragma once

namespace facezip::test {

// --- texels
// -----------------------------------------------------------------------------------------------------------

// 16-bit and float differences: one rounding of the subtraction and one of the scaling, each half a unit of 2^-24,
// relative to the larger sample (255 full scale). 8-bit differences are exact and are compared so.
inline constexpr double kDifferenceRelative = 2e-7;

// A texture at a place, relative to full scale: 16 products in float32 with weights that sum to at most 1.6 in magnitude,
// whose own rounding, of polynomials in a fraction that is exact, is a few units of 2^-24.
inline constexpr double kResampleRelative = 1e-6;

// Gram matrices, relative to sqrt(G[n,n] G[m,m]): at most 256 float32 products of a tile one after the other, then 64
// tiles one after the other, each addition half a unit of 2^-24. All errors of one sign would give 320 * 6e-8 = 2e-5;
// they are not, and a running sum over the whole band, the fault to be caught, is off by 1e-3 and more.
inline constexpr double kGramRelative = 2e-6;

// Difference textures, relative to the largest difference: K masks times N expressions of multiply-adds in float32;
// weights and coefficients are 0..1 and sum to at most 1 each, so errors do not grow with K and N.
inline constexpr double kDifferenceTextureRelative = 2e-6;

// Codes of difference textures, as a share of the largest code: exact, but for values this close to half way between
// two codes, where the rounding of (value - offset) / scale in float32 decides: of the difference, the reciprocal, the
// product and the sum with 1/2, each half a unit of 2^-23.
inline constexpr double kEncodeTie = 2.5e-7;

// Difference textures of given weights, relative to full scale times the condition of the texel's system: a Cholesky
// factorisation of up to 8 x 8 in float32 is off by a few units of 2^-24 times the condition.
inline constexpr double kSolveRelative = 2e-6;

// Squared error of a tile from the sums that its textures were solved with, relative to its energy: e - 2 b.D + D.A D
// cancels all but the error; each sum has up to 100 float32 terms.
inline constexpr double kFitErrorRelative = 1e-5;

// Normal equations of a cell, relative to its diagonal: at most 1024 products in float32, in runs of 16 and 16.
inline constexpr double kSystemRelative = 1e-5;

// Equations of a cell from those of its half cells, relative to all that these hold: their own error (kSolveRelative
// times the condition of a half cell, tens in the tests), sixteen of them weighed.
inline constexpr double kGatheredHalfCells = 1e-4;

// Compress and stretch maps, for every expression, in 1/255: a weight of up to 1.5 that is interpolated in float32, off
// by a few units of 2^-24, times a difference of up to 510.
inline constexpr double kCompressStretch = 2e-3;

// Grid weights after two sweeps: the system's error times the condition of a cell's block, which trust and smoothness
// bound by about 1e4 in the tests.
inline constexpr double kRelaxedWeight = 5e-4;

// Frames of 8 bits, in steps for every unit of scale and of weight: -scale (zero + 32768) is a float32 of up to 1.5 *
// 2^15, off by 2^-9 at most, and by less where the scale is below 1/2.
inline constexpr double kFoldedCodeBias = 1.0 / 512.0;

// Texels of BC4 blocks, in code units: float32 between two codes, half a unit of 2^-16 twice or so.
inline constexpr double kBetweenEnds = 5e-5;

// Texels of mip levels, in code units: two sums of three products and a division a level, each half a unit of 2^-16,
// over six levels.
inline constexpr double kMipTexel = 2e-4;

// --- search on Gram matrices -----------------------------------------------------------------------------------------

/// Seam costs, as a share of the largest squared length of a centred fragment of the pair. e^T H e has entries of H
/// below 1 and |e|_1 <= 2, so rounding H (2^-24) moves it by 4 * 2^-24; the sums over up to 129 rows and 129 columns
/// add about sqrt(129) * 2^-24 each. 1e-5 is five times their sum.
inline constexpr double kSeamCost = 1e-5;

/// Squared distances from a fragment to centres, as a share of the largest squared length of a centred fragment: the
/// same sums. Two centres that differ by less may change places under rounding.
inline constexpr double kCentreDistance = 1e-5;

/// Runs of k-means whose labels may differ from the reference in double, as a share of all. A run goes another way
/// where a random draw falls within 1e-6 of the border between two fragments, or a fragment within 1e-6 of the middle
/// between two centres; with tens of such decisions a run, fewer than one run in a thousand.
inline constexpr double kDivergedRuns = 2e-3;

/// Sums of doubles over the same values in another order, relative.
inline constexpr double kDoubleSum = 1e-9;

/// Weight maps: 255 W is summed in float to about 1e-4, so the byte may fall on the other side of a half only where
/// 255 W + 1/2 lies this near to an integer.
inline constexpr double kWeightRounding = 1e-3;

/// Reconstruction from float coefficients and masks, relative to the largest difference: a handful of products of
/// 2^-24.
inline constexpr double kExactReconstruction = 1e-6;

}  // namespace facezip::test
