// common.h - what every kernel uses.
#ifndef FACEZIP_COMMON_H
#define FACEZIP_COMMON_H

#include "layout.h"

// A multiply-add that becomes one instruction where the device has one. fma() would be tens of times slower where it has
// none, and mad() stays two instructions on PoCL.
#pragma OPENCL FP_CONTRACT ON
#define FMA(a, b, c) ((a) * (b) + (c))

// Type names from macros: JOIN(float, WIDTH).
#define JOIN_(a, b) a##b
#define JOIN(a, b) JOIN_(a, b)

// Halves added to halves: one order on every device.
inline float sum_of_16(const float16 value) {
  const float8 half8 = value.lo + value.hi;
  const float4 half4 = half8.lo + half8.hi;
  const float2 half2 = half4.lo + half4.hi;
  return half2.x + half2.y;
}

#endif
