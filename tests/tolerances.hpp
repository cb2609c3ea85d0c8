// tolerances.hpp - how far a result may lie from its reference, and why. One place, so that a loosened bound is seen.
#pragma once

namespace facezip::test {

// 16-bit and float differences: one rounding of the subtraction and one of the scaling, each half a unit of 2^-24,
// relative to the larger sample (255 full scale). 8-bit differences are exact and are compared so.
inline constexpr double kDifferenceRelative = 2e-7;

// Gram matrices, relative to sqrt(G[n,n] G[m,m]): at most 256 float32 products of a tile one after the other, then 64
// tiles one after the other, each addition half a unit of 2^-24. All errors of one sign would give 320 * 6e-8 = 2e-5;
// they are not, and a running sum over the whole band, the fault to be caught, is off by 1e-3 and more.
inline constexpr double kGramRelative = 2e-6;

// Difference textures, relative to the largest difference: K masks times N expressions of multiply-adds in float32;
// weights and coefficients are 0..1 and sum to at most 1 each, so errors do not grow with K and N.
inline constexpr double kDifferenceTextureRelative = 2e-6;

// Encoded bytes: exact, but for values this close to half way between two bytes, where the rounding of
// (value - offset) / scale in float32 (255 * 6e-8, and as much again from the reference's own scale) decides.
inline constexpr double kEncodeTie = 1e-3;

}  // namespace facezip::test
