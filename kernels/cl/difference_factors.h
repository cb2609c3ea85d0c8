// difference_factors.h - the factored systems of difference textures, as difference_fit.cl leaves them with FACTORS.
//   A = sum_n w_n w_n^T + ridge = L L^T,   y = L^-1 sum_n w_n Delta_n,   left = sum_n |Delta_n|^2 - |y|^2
// The textures that suit the weights best are L^-T y: the last one first, each from those behind it. What any textures D
// leave is  left + |L^T D - y|^2 - ridge |D|^2.
//   factors  [tile][FACTOR_PLANES][256] float: L with 1 / its diagonal there, entry (i, j) at LOWER(i, j);
//            then y as [C][channel]; then left. Where no texture is wanted, L is 1 and y is 0.
#ifndef FACEZIP_DIFFERENCE_FACTORS_H
#define FACEZIP_DIFFERENCE_FACTORS_H

#include "grid_weights.h"
#include "tiles.h"

#define SIDE_PLANES PAIRS
#define LEFT_PLANE (SIDE_PLANES + TEXTURES * CHANNELS)
#define FACTOR_PLANES FACEZIP_FACTOR_PLANES(TEXTURES, CHANNELS)

#endif
