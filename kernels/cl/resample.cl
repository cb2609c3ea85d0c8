// resample.cl - a texture at given places, by Catmull-Rom cubics (Keys 1981, "Cubic convolution interpolation", a = -1/2)
//   samples[i][c] = sum over the 4 x 4 texels around place i of w(y - y_i) w(x - x_i) source[y][x][c]
// Beyond an edge the texture repeats its outermost texels. A place that is not a number leaves its samples as they are.
//
// NDRange  global {roundUp(count, WGS)}, local {WGS}: a work-item a place. Places come in the order of another layout, so
//          what neighbours read is scattered, and lanes side by side would gain nothing
// Buffers  source   in   [height][width][CHANNELS] SAMPLE_T
//          places   in   [count][2] float   x, y in texels of the source, whose centres are at integers
//          samples  out  [count][CHANNELS] float, in units of the source's samples; may go beyond its range a little
// Defines  CHANNELS  1 to 4 (3)
//          SAMPLE_T  uchar, ushort or float (uchar)

#include "common.h"

#ifndef CHANNELS
#define CHANNELS 3
#endif
#ifndef SAMPLE_T
#define SAMPLE_T uchar
#endif

// Weights of the four texels around a place `f` (0..1) behind the second one.
static float4 cubic_weights(const float f) {
  return (float4)(f * FMA(f, FMA(-0.5f, f, 1.0f), -0.5f), FMA(f * f, FMA(1.5f, f, -2.5f), 1.0f),
                  f * FMA(f, FMA(-1.5f, f, 2.0f), 0.5f), f * f * FMA(0.5f, f, -0.5f));
}

static void add_row(global const SAMPLE_T* row, const int4 columns, const float4 weights, float* sums) {
  for (int c = 0; c < CHANNELS; ++c) {
    sums[c] = FMA(weights.s0, (float)row[columns.s0 * CHANNELS + c], sums[c]);
    sums[c] = FMA(weights.s1, (float)row[columns.s1 * CHANNELS + c], sums[c]);
    sums[c] = FMA(weights.s2, (float)row[columns.s2 * CHANNELS + c], sums[c]);
    sums[c] = FMA(weights.s3, (float)row[columns.s3 * CHANNELS + c], sums[c]);
  }
}

kernel void resample(global const SAMPLE_T* source, global const float* places, global float* samples, const ulong count,
                     const int width, const int height) {
  const ulong i = get_global_id(0);
  if (i >= count) return;
  const float x = places[2 * i], y = places[2 * i + 1];
  if (isnan(x) || isnan(y)) return;
  const float left = floor(x), top = floor(y);
  const int4 offsets = (int4)(-1, 0, 1, 2);
  const int4 columns = clamp((int4)((int)left) + offsets, (int4)(0), (int4)(width - 1));
  const int4 rows = clamp((int4)((int)top) + offsets, (int4)(0), (int4)(height - 1));
  const float4 across = cubic_weights(x - left), down = cubic_weights(y - top);
  const ulong row = (ulong)width * CHANNELS;

  float sums[CHANNELS];
  for (int c = 0; c < CHANNELS; ++c) sums[c] = 0.0f;
  add_row(source + (ulong)rows.s0 * row, columns, down.s0 * across, sums);
  add_row(source + (ulong)rows.s1 * row, columns, down.s1 * across, sums);
  add_row(source + (ulong)rows.s2 * row, columns, down.s2 * across, sums);
  add_row(source + (ulong)rows.s3 * row, columns, down.s3 * across, sums);
  for (int c = 0; c < CHANNELS; ++c) samples[i * CHANNELS + c] = sums[c];
}
