// lanes.h - one source for CPUs and GPUs: how many texels, cells or expressions a work-item has at once.
#ifndef FACEZIP_LANES_H
#define FACEZIP_LANES_H

#include "common.h"

// 16 on CPUs, one on GPUs, whose work-items lie side by side themselves.
#ifndef LANES
#define LANES 16
#endif

#if LANES == 1
#define VECTOR(type) type
#else
#define VECTOR(type) JOIN(type, LANES)
#endif
typedef VECTOR(float) floats;
#define TO_FLOATS JOIN(convert_, VECTOR(float))

#endif
