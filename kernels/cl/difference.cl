// difference.cl - differences of the expressions to the neutral, Delta_n = I_n - I_0 (FaceZip, Eq. 1 and 2), as tiles
//   differences[tile][n][c][t] = (samples[n + 1][y][x][c] - neutral[y][x][c]) * SAMPLE_UNIT * fades[tile][t],
//                                0 outside the band
//
// NDRange  global {16, tiles, expressions}, local {16, 1, 1}: one work-item per row of 16 texels of a tile
// Buffers  tiles        in   [tile] int2      column and row of tiles in the band
//          samples      in   [1 + expressions][rows][width][CHANNELS] SAMPLE_T, image 0 is the neutral
//          neutral      in   [rows][width][CHANNELS] NEUTRAL_T: the samples' own, or what a coded one decodes to
//          fades        in   [tile][256] float, 0 to 1: with FADED alone
//          differences  out  [tile][expression][channel][256] DIFF_T, units of 1/255 of full scale
// Defines  CHANNELS, DIFF_T  tiles.h
//          SAMPLE_T          uchar, ushort or float (uchar)
//          SAMPLE_UNIT       factor from a sample to 1/255 of full scale; not defined for uchar, whose differences to
//                            a neutral of uchar stay integers
//          NEUTRAL_T         SAMPLE_T, or float in units of 1/255 with NEUTRAL_DECODED
//          NEUTRAL_DECODED   if set, that type; DIFF_T is float then
//          FADED             if set, there are fades; 16-bit differences are rounded

#include "tiles.h"

#ifndef SAMPLE_T
#define SAMPLE_T uchar
#endif

#ifdef NEUTRAL_DECODED
#define NEUTRAL_T float
#else
#define NEUTRAL_T SAMPLE_T
#endif

#define SAMPLE16 JOIN(SAMPLE_T, 16)
#define DIFF16 JOIN(DIFF_T, 16)
#define CONVERT16 JOIN(convert_, DIFF16)

// Subtracts before splitting: one split instead of two, and 16-bit lanes have permutes that bytes lack.
#if defined(NEUTRAL_DECODED) && defined(SAMPLE_UNIT)
#define DIFFERENCE(convert, expression, neutral) (convert(expression) * SAMPLE_UNIT - (neutral))
#elif defined(SAMPLE_UNIT)
#define DIFFERENCE(convert, expression, neutral) ((convert(expression) - convert(neutral)) * SAMPLE_UNIT)
#else
#define DIFFERENCE(convert, expression, neutral) (convert(expression) - convert(neutral))
#endif

// Writes a row of 16 interleaved texels as CHANNELS planes. Assigned through an aligned pointer: vstore16 promises the
// compiler no alignment, and PoCL then stores sample by sample. Element by element, since a swizzle of four (a.s048c) widens
// through undefined lanes, which Oclgrind cannot follow.
static void store_planes(const DIFF16* x, global DIFF_T* row) {
  global DIFF16* out = (global DIFF16*)row;
  const int plane = TILE_SIDE;  // rows of 16 between the planes of a tile
#if CHANNELS == 1
  out[0] = x[0];
#elif CHANNELS == 2
  const DIFF16 a = x[0], b = x[1];
  out[0] = (DIFF16)(a.s0, a.s2, a.s4, a.s6, a.s8, a.sa, a.sc, a.se, b.s0, b.s2, b.s4, b.s6, b.s8, b.sa, b.sc, b.se);
  out[plane] = (DIFF16)(a.s1, a.s3, a.s5, a.s7, a.s9, a.sb, a.sd, a.sf, b.s1, b.s3, b.s5, b.s7, b.s9, b.sb, b.sd, b.sf);
#elif CHANNELS == 3
  const DIFF16 a = x[0], b = x[1], c = x[2];
  out[0] = (DIFF16)(a.s0, a.s3, a.s6, a.s9, a.sc, a.sf, b.s2, b.s5, b.s8, b.sb, b.se, c.s1, c.s4, c.s7, c.sa, c.sd);
  out[plane] = (DIFF16)(a.s1, a.s4, a.s7, a.sa, a.sd, b.s0, b.s3, b.s6, b.s9, b.sc, b.sf, c.s2, c.s5, c.s8, c.sb, c.se);
  out[2 * plane] =
      (DIFF16)(a.s2, a.s5, a.s8, a.sb, a.se, b.s1, b.s4, b.s7, b.sa, b.sd, c.s0, c.s3, c.s6, c.s9, c.sc, c.sf);
#else
  const DIFF16 a = x[0], b = x[1], c = x[2], d = x[3];
  out[0] = (DIFF16)(a.s0, a.s4, a.s8, a.sc, b.s0, b.s4, b.s8, b.sc, c.s0, c.s4, c.s8, c.sc, d.s0, d.s4, d.s8, d.sc);
  out[plane] = (DIFF16)(a.s1, a.s5, a.s9, a.sd, b.s1, b.s5, b.s9, b.sd, c.s1, c.s5, c.s9, c.sd, d.s1, d.s5, d.s9, d.sd);
  out[2 * plane] =
      (DIFF16)(a.s2, a.s6, a.sa, a.se, b.s2, b.s6, b.sa, b.se, c.s2, c.s6, c.sa, c.se, d.s2, d.s6, d.sa, d.se);
  out[3 * plane] =
      (DIFF16)(a.s3, a.s7, a.sb, a.sf, b.s3, b.s7, b.sb, b.sf, c.s3, c.s7, c.sb, c.sf, d.s3, d.s7, d.sb, d.sf);
#endif
}

#ifdef FADED
#define ROUND_short convert_short16_rte
#define ROUND_float convert_float16

// Fades what store_planes() wrote. Apart from it: few captures have anything to fade.
static void fade_planes(const float16 fade, global DIFF_T* row) {
  for (int c = 0; c < CHANNELS; ++c) {
    global DIFF16* plane = (global DIFF16*)(row + c * TILE_TEXELS);
    *plane = JOIN(ROUND_, DIFF_T)(convert_float16(*plane) * fade);
  }
}
#endif

// A row of which only the first `inside` texels (0 to 15) belong to the band.
static void edge_row(global const SAMPLE_T* expression, global const NEUTRAL_T* neutral, int inside, DIFF16* x) {
  DIFF_T* samples = (DIFF_T*)x;
  for (int i = 0; i < TILE_SIDE * CHANNELS; ++i) {
    samples[i] = 0;
    if (i < inside * CHANNELS) samples[i] = DIFFERENCE((DIFF_T), expression[i], neutral[i]);
  }
}

kernel void difference(global const int2* tiles, global const SAMPLE_T* samples, global const NEUTRAL_T* neutrals,
#ifdef FADED
                       global const float* fades,
#endif
                       global DIFF_T* differences, int width, int rows) {
  const int row = (int)get_global_id(0);
  const ulong tile = get_global_id(1);
  const ulong n = get_global_id(2);
  const ulong expressions = get_global_size(2);
  const int x = tiles[tile].x * TILE_SIDE;
  const int y = tiles[tile].y * TILE_SIDE + row;
  const int inside = y < rows ? clamp(width - x, 0, TILE_SIDE) : 0;

  const ulong at = ((ulong)min(y, rows - 1) * (ulong)width + (ulong)x) * CHANNELS;
  const ulong image = (ulong)rows * (ulong)width * CHANNELS;
  global const NEUTRAL_T* neutral = neutrals + at;
  global const SAMPLE_T* expression = samples + at + (n + 1) * image;
  DIFF16 rows_of_16[CHANNELS];
  if (inside == TILE_SIDE) {
    for (int c = 0; c < CHANNELS; ++c) rows_of_16[c] = DIFFERENCE(CONVERT16, vload16(c, expression), vload16(c, neutral));
  } else {
    edge_row(expression, neutral, inside, rows_of_16);
  }
  global DIFF_T* out = differences + (tile * expressions + n) * CHANNELS * TILE_TEXELS + row * TILE_SIDE;
  store_planes(rows_of_16, out);
#ifdef FADED
  fade_planes(vload16(0, fades + tile * TILE_TEXELS + row * TILE_SIDE), out);
#endif
}
