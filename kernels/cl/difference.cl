// difference.cl - differences of the expressions to the neutral, Delta_n = I_n - I_0 (FaceZip, Eq. 1 and 2), as tiles
//   differences[tile][n][c][t] = (samples[n + 1][y][x][c] - samples[0][y][x][c]) * SAMPLE_UNIT,  0 outside the band
// NDRange  global {16, tiles, expressions}, local {16, 1, 1}: one work-item per row of 16 texels of a tile
// Buffers  tiles        in   [tile] int2      column and row of tiles in the band
//          samples      in   [1 + expressions][rows][width][CHANNELS] SAMPLE_T, image 0 is the neutral
//          differences  out  [tile][expression][channel][256] DIFF_T, units of 1/255 of full scale
// Defines  CHANNELS     1 to 4
//          SAMPLE_T     uchar, ushort or float
//          SAMPLE_UNIT  factor from a sample to 1/255 of full scale (1 for uchar)
//          DIFF_T       short for uchar samples (exact), float for all others

#ifndef CHANNELS
#define CHANNELS 3
#endif
#ifndef SAMPLE_T
#define SAMPLE_T uchar
#define SAMPLE_UNIT 1.0f
#define DIFF_T short
#define DIFF_IS_INTEGER
#endif

#define JOIN_(a, b) a##b
#define JOIN(a, b) JOIN_(a, b)
#define SAMPLE16 JOIN(SAMPLE_T, 16)

// SPLIT turns a row of 16 interleaved texels, read from `row`, into one vector per channel. Constant swizzles become
// register permutes; sixteen strided loads a channel are several times slower.
#if CHANNELS == 1
#define SPLIT(row, out) (out)[0] = vload16(0, row);
#elif CHANNELS == 2
#define SPLIT(row, out)                              \
  {                                                  \
    const SAMPLE16 a = vload16(0, row);              \
    const SAMPLE16 b = vload16(1, row);              \
    (out)[0] = (SAMPLE16)(a.even, b.even);           \
    (out)[1] = (SAMPLE16)(a.odd, b.odd);             \
  }
#elif CHANNELS == 3
#define SPLIT(row, out)                                                                     \
  {                                                                                         \
    const SAMPLE16 a = vload16(0, row);                                                     \
    const SAMPLE16 b = vload16(1, row);                                                     \
    const SAMPLE16 c = vload16(2, row);                                                     \
    (out)[0] = (SAMPLE16)(a.s0369, a.scf, b.s258b, b.se, c.s147a, c.sd);                    \
    (out)[1] = (SAMPLE16)(a.s147a, a.sd, b.s0369, b.scf, c.s258b, c.se);                    \
    (out)[2] = (SAMPLE16)(a.s258b, a.se, b.s147a, b.sd, c.s0369, c.scf);                    \
  }
#else
#define SPLIT(row, out)                                                     \
  {                                                                         \
    const SAMPLE16 a = vload16(0, row);                                     \
    const SAMPLE16 b = vload16(1, row);                                     \
    const SAMPLE16 c = vload16(2, row);                                     \
    const SAMPLE16 d = vload16(3, row);                                     \
    (out)[0] = (SAMPLE16)(a.s048c, b.s048c, c.s048c, d.s048c);              \
    (out)[1] = (SAMPLE16)(a.s159d, b.s159d, c.s159d, d.s159d);              \
    (out)[2] = (SAMPLE16)(a.s26ae, b.s26ae, c.s26ae, d.s26ae);              \
    (out)[3] = (SAMPLE16)(a.s37bf, b.s37bf, c.s37bf, d.s37bf);              \
  }
#endif

#ifdef DIFF_IS_INTEGER
#define DIFFERENCE(expression, neutral) (convert_short16(expression) - convert_short16(neutral))
#else
#define DIFFERENCE(expression, neutral) ((convert_float16(expression) - convert_float16(neutral)) * SAMPLE_UNIT)
#endif

// Splits the row that starts at `row`, of which `inside` texels (0 to 16) belong to the band; the others become 0.
static void load_row(global const SAMPLE_T* row, int inside, SAMPLE16* channels) {
  if (inside == TILE_SIDE) {
    SPLIT(row, channels)
    return;
  }
  SAMPLE_T edge[TILE_SIDE * CHANNELS];
  for (int i = 0; i < TILE_SIDE * CHANNELS; ++i) {
    edge[i] = 0;
    if (i < inside * CHANNELS) edge[i] = row[i];
  }
  SPLIT(edge, channels)
}

kernel void difference(global const int2* tiles, global const SAMPLE_T* samples, global DIFF_T* differences, int width,
                       int rows) {
  const int row = (int)get_global_id(0);
  const ulong tile = get_global_id(1);
  const ulong n = get_global_id(2);
  const ulong expressions = get_global_size(2);
  const int x = tiles[tile].x * TILE_SIDE;
  const int y = tiles[tile].y * TILE_SIDE + row;
  const int inside = y < rows ? clamp(width - x, 0, TILE_SIDE) : 0;

  const ulong at = ((ulong)min(y, rows - 1) * (ulong)width + (ulong)x) * CHANNELS;
  const ulong image = (ulong)rows * (ulong)width * CHANNELS;
  SAMPLE16 neutral[CHANNELS];
  SAMPLE16 expression[CHANNELS];
  load_row(samples + at, inside, neutral);
  load_row(samples + (n + 1) * image + at, inside, expression);

  global DIFF_T* out = differences + (tile * expressions + n) * CHANNELS * TILE_TEXELS + row * TILE_SIDE;
  for (int c = 0; c < CHANNELS; ++c) vstore16(DIFFERENCE(expression[c], neutral[c]), 0, out + c * TILE_TEXELS);
}
