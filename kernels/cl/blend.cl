// blend.cl - one frame of one map from its neutral, its difference textures and the blended weights (FaceZip, Eq. 8)
//   T(p) = I_0(p) + sum_i D_i(p) w_i(p),   D_ic = scale_ic * (code - zero_ic),   w_i bilinear between cells
//   Texel centre (x + 0.5) / s - 0.5 in cells, clamped to the grid.
//
// A tile is 16 x 8 texels. Its weights need few cells, so interpolation is hoisted: along x once per tile, for the
// CELL_ROWS rows of cells that the tile touches; along y once per texel row.
//
//      cells of the tile       hat functions along x            rows of 16 lanes, lerp along y
//      o   o   o   o           .  /\  /\  .                     h[0] ----------------
//      o   o   o   o     ->    . /  \/  \ .       ->            h[1] ----------------   -> w_i of each texel row
//      o   o   o   o           ./   /\   \.                     h[2] ----------------
//
// PoCL unrolls no loop by itself: without the pragmas h, w and value live in memory, and a third of the speed is lost.
//
// On PoCL, frames of 8 bits are bound by arithmetic as much as by memory, and most of it would be making floats of codes.
// So there these are stored in quads, of four planes and four texels each, whose bytes two steps of interleaving, with
// zeros and with 0x4700, turn into floats of four planes: code c becomes the bytes 00 cc 00 47, which are 32768 + c.
//
//      quad of texels 0..3       0  1  2  3 of plane p | of plane p + 1 | of plane p + 2 | of plane p + 3
//      a plane's texels 0..15    bytes 4 j to 4 j + 3 of the four quads of planes p to p + 3, j = plane - p
//
//
// NDRange   global {tiles * 16 / LANES}, rounded up to the local size; a work-item has LANES columns of one tile
// Buffers   textures  in   [tile]: neutral [row 8][channel][16] NEUTRAL, then codes [row 8] of planes [channel][C]:
//                          QUAD_PLANES of them as [plane / 4][quad 4][plane % 4][4], the others as [16] CODE. Tiles are
//                          row-major and whole cache lines, so that 64 bytes of quads are one line
//           weights   in   [cell / 16][C][16]         float  weight_blend.cl's output
//           encoding  in   [3][C][channels]           float  scale_ic in steps of a sample, zero_ic and
//                                    -scale_ic * (zero_ic + CODE_BIAS for planes in quads)
//           frame     out  [8 * tile rows][16 * tiles_x][channels] FRAME  interleaved
// Defines   CHANNELS        1 to 4 (3)
//           DIFFERENCES     C, 1 to 8 (4)
//           SCALE           s, texels to a cell (8)
//           LANES           16 on CPUs, 1 on GPUs (16)
//           SAMPLE_TYPE     0 uchar, 1 ushort, 2 float (0)
//           NEUTRAL_TYPE    of the neutral; that of a frame, or 1 beside frames of 8 bits (SAMPLE_TYPE)
//           CODE_BITS       8 or 16 (8)
//           CLANG_BUILTINS  1: the compiler is clang (PoCL), which knows prefetches, and shuffles of 64 bytes (0)
//           QUAD_PLANES     0, or with CLANG_BUILTINS, LANES 16, 8-bit samples, neutral and codes a multiple of 4 (0)
//           VALUES          0: FRAME is SAMPLE; 1: FRAME is float, T in 1/255 of full scale, before rounding (0)
// Rounding  integers: half up, clamped to the type; floats: neither, and I_0 is copied where the sum is 0;
//           values: neither, exact where the sum is 0 in 8 bits

#include "lanes.h"

#ifndef CHANNELS
#define CHANNELS 3
#endif
#ifndef DIFFERENCES
#define DIFFERENCES 4
#endif
#ifndef SCALE
#define SCALE 8
#endif
#ifndef SAMPLE_TYPE
#define SAMPLE_TYPE 0
#endif
#ifndef NEUTRAL_TYPE
#define NEUTRAL_TYPE SAMPLE_TYPE
#endif
#ifndef VALUES
#define VALUES 0
#endif
#ifndef QUAD_PLANES
#define QUAD_PLANES 0
#endif
#ifndef CLANG_BUILTINS
#define CLANG_BUILTINS 0
#endif
#ifndef CODE_BITS
#define CODE_BITS 8
#endif

#define TILE_WIDTH FACEZIP_TILE_SIDE
#define TILE_ROWS FACEZIP_BLEND_TILE_ROWS
#define TILES_AHEAD 2  // that are asked for while one is blended
#define CODE_BIAS FACEZIP_CODE_BIAS
#define PLANES (DIFFERENCES * CHANNELS)
// Cells touched by 16 columns and by 8 rows of texels, wherever the tile lies.
#define CELL_COLUMNS ((TILE_WIDTH - 1) / SCALE + 3)
#define CELL_ROWS ((TILE_ROWS - 1) / SCALE + 3)

#if CODE_BITS == 16
#define CODE ushort
#else
#define CODE uchar
#endif
typedef VECTOR(CODE) codes;

#if CLANG_BUILTINS
// 16 texels in one register of 512 bits. OpenCL C ends at 16 lanes; clang does not.
typedef uchar uchar64 __attribute__((ext_vector_type(64)));
typedef ushort ushort32 __attribute__((ext_vector_type(32)));
typedef union {
  uint16 words;
  float16 values;
  ushort32 halves;
  uchar64 bytes;
} texels16;
#endif

#if SAMPLE_TYPE == 0
#define SAMPLE uchar
#define SAMPLE_MAX 255.0f
#define UNIT_255 1.0f  // a step of a sample in 1/255 of full scale
#elif SAMPLE_TYPE == 1
#define SAMPLE ushort
#define SAMPLE_MAX 65535.0f
#define UNIT_255 (1.0f / 257.0f)
#else
#define SAMPLE float
#define UNIT_255 255.0f
#endif

// What blocks decode to lies between the samples of 8 bits.
#if NEUTRAL_TYPE == SAMPLE_TYPE
#define NEUTRAL SAMPLE
#define NEUTRAL_STEP 1.0f
#else
#define NEUTRAL ushort
#define NEUTRAL_STEP (1.0f / 257.0f)
#endif
typedef VECTOR(NEUTRAL) neutrals;

#define NEUTRAL_ROW_BYTES (TILE_WIDTH * CHANNELS * sizeof(NEUTRAL))
#define CODE_ROW_BYTES (TILE_WIDTH * PLANES * sizeof(CODE))
#define TILE_BYTES (TILE_ROWS * (NEUTRAL_ROW_BYTES + CODE_ROW_BYTES))
#define LINE_BYTES 64  // what a prefetch brings
#define TILE_LINES (TILE_BYTES / LINE_BYTES)

#if VALUES
#define FRAME float
#define FRAME_TYPE 2
#else
#define FRAME SAMPLE
#define FRAME_TYPE SAMPLE_TYPE
#endif
typedef VECTOR(FRAME) frames;

// What a sample becomes before it is narrowed: kept wide so that 8-bit channels can be packed by shifts.
#if FRAME_TYPE == 2
typedef floats results;
#else
typedef VECTOR(uint) results;
#endif

// Rounding's half starts the sum of a frame that is rounded, and a difference is one multiply-add: off by 1e-5 of a step
// where it should be 0, by 2^-9 of a step where CODE_BIAS is folded into the encoding. The others have to be exact there.
#if FRAME_TYPE == 2
#define START(neutral) ((floats)(0.0f))
#define DIFFERENCE(code, plane) (((code)-encoding[PLANES + (plane)]) * encoding[plane])
#else
#define START(neutral) ((neutral) + 0.5f)
#define DIFFERENCE(code, plane) fma(code, (floats)(encoding[plane]), (floats)(encoding[2 * PLANES + (plane)]))
#endif

inline results finish(const floats neutral, const floats sum) {
#if VALUES
  return (neutral + sum) * UNIT_255;
#elif SAMPLE_TYPE == 2
  return sum == (floats)(0.0f) ? neutral : neutral + sum;  // -0 and denormals of the neutral survive
#else
  // Not convert_*_sat_rte: it costs a third of the whole blend on PoCL.
  return JOIN(convert_, VECTOR(uint))(clamp(sum, 0.0f, SAMPLE_MAX));
#endif
}

// Writes 16 texels (or one) of CHANNELS interleaved samples. Little-endian devices, as every OpenCL device today is.
inline void store(global FRAME* out, const results* value) {
#if LANES == 1
#pragma unroll
  for (int c = 0; c < CHANNELS; ++c) out[c] = (FRAME)value[c];
#elif CHANNELS == 1 && FRAME_TYPE == 2
  *(global float16*)out = value[0];
#elif CHANNELS == 1
  *(global frames*)out = JOIN(convert_, VECTOR(FRAME))(value[0]);
#elif CHANNELS == 2 && FRAME_TYPE == 0
  *(global ushort16*)out = convert_ushort16(value[0] | value[1] << 8);
#elif CHANNELS == 2 && FRAME_TYPE == 1
  *(global uint16*)out = value[0] | value[1] << 16;
#elif CHANNELS == 4 && FRAME_TYPE == 0
  *(global uint16*)out = value[0] | value[1] << 8 | value[2] << 16 | value[3] << 24;
#elif CHANNELS == 3 && FRAME_TYPE == 0
  // Texels as RGB0 words, of which 12 leave.
  const uint16 texels = value[0] | value[1] << 8 | value[2] << 16;
#if CLANG_BUILTINS
#define RGB_OF_4(t) t, t + 1, t + 2, t + 4, t + 5, t + 6, t + 8, t + 9, t + 10, t + 12, t + 13, t + 14
  texels16 packed;
  packed.words = texels;
  packed.bytes = __builtin_shufflevector(packed.bytes, packed.bytes, RGB_OF_4(0), RGB_OF_4(16), RGB_OF_4(32),
                                         RGB_OF_4(48), 3, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3);
  const uint16 words = packed.words;
#else
  // Word k joins the ends of two neighbours. Four lanes are spare. shuffle2 would be three times slower than all the rest.
  const uint16 low = texels.s01245689acde0000 >> (uint16)(0, 8, 16, 0, 8, 16, 0, 8, 16, 0, 8, 16, 0, 0, 0, 0);
  const uint16 high = texels.s1235679abdef0000 << (uint16)(24, 16, 8, 24, 16, 8, 24, 16, 8, 24, 16, 8, 0, 0, 0, 0);
  const uint16 words = low | high;
#endif
  // Word by word: PoCL merges the stores.
  global uint* to = (global uint*)out;
  to[0] = words.s0;
  to[1] = words.s1;
  to[2] = words.s2;
  to[3] = words.s3;
  to[4] = words.s4;
  to[5] = words.s5;
  to[6] = words.s6;
  to[7] = words.s7;
  to[8] = words.s8;
  to[9] = words.s9;
  to[10] = words.sa;
  to[11] = words.sb;
#else
  FRAME lanes[CHANNELS][16];
#pragma unroll
  for (int c = 0; c < CHANNELS; ++c) vstore16(JOIN(convert_, VECTOR(FRAME))(value[c]), 0, lanes[c]);
  for (int x = 0; x < 16; ++x) {
#pragma unroll
    for (int c = 0; c < CHANNELS; ++c) out[x * CHANNELS + c] = lanes[c][x];
  }
#endif
}

#if QUAD_PLANES > 0
// Bytes from `from` on of a second register, each behind one of the first.
#define EIGHT_BYTES(from) \
  from, 64 + from, from + 1, 65 + from, from + 2, 66 + from, from + 3, 67 + from, \
  from + 4, 68 + from, from + 5, 69 + from, from + 6, 70 + from, from + 7, 71 + from
#define FOUR_HALVES(from) from, 32 + from, from + 1, 33 + from, from + 2, 34 + from, from + 3, 35 + from

typedef uint16 __attribute__((aligned(16))) uint16_of_quads;

// 32768 + code of four planes, from the 64 bytes of their quads. The indices are those of unpack instructions, which
// interleave within 16 bytes.
inline void widen_quads(global const uchar* quads, floats code[4]) {
  texels16 all, zeros, magic, low, high, wide;
  all.words = *(global const uint16_of_quads*)quads;
  zeros.words = 0;
  magic.words = 0x47004700;
  low.bytes = __builtin_shufflevector(zeros.bytes, all.bytes, EIGHT_BYTES(0), EIGHT_BYTES(16), EIGHT_BYTES(32),
                                      EIGHT_BYTES(48));
  high.bytes = __builtin_shufflevector(zeros.bytes, all.bytes, EIGHT_BYTES(8), EIGHT_BYTES(24), EIGHT_BYTES(40),
                                       EIGHT_BYTES(56));
#define WIDEN(words, from)                                                                                   \
  wide.halves = __builtin_shufflevector(words.halves, magic.halves, FOUR_HALVES(from), FOUR_HALVES(8 + from), \
                                        FOUR_HALVES(16 + from), FOUR_HALVES(24 + from))
  WIDEN(low, 0);
  code[0] = wide.values;
  WIDEN(low, 4);
  code[1] = wide.values;
  WIDEN(high, 0);
  code[2] = wide.values;
  WIDEN(high, 4);
  code[3] = wide.values;
}
#endif

// Codes of all planes of one texel row, as floats; those of quads with CODE_BIAS, where that is folded into the encoding.
inline void load_codes(global const uchar* row, const uint lane, floats code[PLANES]) {
#if QUAD_PLANES > 0
#pragma unroll
  for (int plane = 0; plane < QUAD_PLANES; plane += 4) widen_quads(row + 16 * plane, code + plane);
#if VALUES
#pragma unroll
  for (int plane = 0; plane < QUAD_PLANES; ++plane) code[plane] -= CODE_BIAS;
#endif
#endif
#pragma unroll
  for (int plane = QUAD_PLANES; plane < PLANES; ++plane) {
    code[plane] = TO_FLOATS(*(global const codes*)((global const CODE*)row + (16 * plane + lane)));
  }
}

// Rounds down for negative numerators too.
inline int floor_divide(const int numerator, const int denominator) {
  return numerator >= 0 ? numerator / denominator : -((denominator - 1 - numerator) / denominator);
}

// h[r][i]: weights of texture i along the tile's columns, on cell row first_cell_row + r.
inline void interpolate_columns(global const float* restrict weights, const int x0, const uint lane,
                                const int first_cell_row, const int cell_columns, const int cell_rows,
                                floats h[CELL_ROWS][DIFFERENCES]) {
  // 2 s times the position of texel x0 in cells is the integer 2 x0 + 1 - s: exact for every s and width.
  const int origin = 2 * x0 + 1 - SCALE;
  const int first_cell = floor_divide(origin, 2 * SCALE);
#if LANES == 1
  const float column = (float)lane;
#else
  const float16 column = (float16)(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
#endif
  const floats position = (column * 2.0f + (float)(origin - 2 * SCALE * first_cell)) * (1.0f / (2 * SCALE));
#pragma unroll
  for (int r = 0; r < CELL_ROWS; ++r) {
#pragma unroll
    for (int i = 0; i < DIFFERENCES; ++i) h[r][i] = 0.0f;
  }
#pragma unroll
  for (int j = 0; j < CELL_COLUMNS; ++j) {
    const floats hat = max(1.0f - fabs(position - (float)j), 0.0f);
    const int cell_x = clamp(first_cell + j, 0, cell_columns - 1);
#pragma unroll
    for (int r = 0; r < CELL_ROWS; ++r) {
      const ulong cell = (ulong)clamp(first_cell_row + r, 0, cell_rows - 1) * (ulong)cell_columns + (ulong)cell_x;
      global const float* w = weights + ((cell >> 4) * DIFFERENCES * 16 + (cell & 15));
#pragma unroll
      for (int i = 0; i < DIFFERENCES; ++i) h[r][i] = fma(hat, w[16 * i], h[r][i]);
    }
  }
}

kernel void blend(global const uchar* restrict textures, global const float* restrict weights,
                  global const float* restrict encoding, global FRAME* restrict frame, const int tiles_x,
                  const ulong tile_count, const int first_tile_row, const int cell_columns, const int cell_rows) {
  const ulong item = get_global_id(0);
  const ulong tile = item / (16 / LANES);
  const uint lane = (uint)(item % (16 / LANES));
  if (tile >= tile_count) return;
  // Not the operator %: with a division beside it, LLVM makes a "freeze", which Oclgrind does not know.
  const int tile_y = (int)(tile / (ulong)tiles_x);
  const int tile_x = (int)(tile - (ulong)tile_y * (ulong)tiles_x);

  const int origin = 2 * TILE_ROWS * (first_tile_row + tile_y) + 1 - SCALE;
  const int first_cell_row = floor_divide(origin, 2 * SCALE);
#if TILE_ROWS % SCALE == 0
  const int phase = SCALE == 1 ? 0 : SCALE + 1;  // the same for every tile, so the compiler resolves the rows below
#else
  const int phase = origin - 2 * SCALE * first_cell_row;
#endif
  floats h[CELL_ROWS][DIFFERENCES];
  interpolate_columns(weights, tile_x * TILE_WIDTH, lane, first_cell_row, cell_columns, cell_rows, h);

  global const uchar* texels = textures + tile * TILE_BYTES;
  global FRAME* out = frame + ((ulong)tile_y * TILE_ROWS * tiles_x + tile_x) * (TILE_WIDTH * CHANNELS) + lane * CHANNELS;
#pragma unroll
  for (int row = 0; row < TILE_ROWS; ++row) {
    const int position = phase + 2 * row;
    const int above = position / (2 * SCALE);
    const float fraction = (float)(position - above * (2 * SCALE)) * (1.0f / (2 * SCALE));
    floats w[DIFFERENCES];
#pragma unroll
    for (int i = 0; i < DIFFERENCES; ++i) w[i] = fma(h[above + 1][i] - h[above][i], fraction, h[above][i]);

#if CLANG_BUILTINS
    // Arithmetic keeps a core from running ahead into the next tiles by itself: a fifth of the time was waiting.
#pragma unroll
    for (int line = row; line < (int)TILE_LINES; line += TILE_ROWS) {
      __builtin_prefetch((const void*)(size_t)(texels + TILES_AHEAD * TILE_BYTES + line * LINE_BYTES));
    }
#pragma unroll
    for (int sample = 0; sample < TILE_WIDTH * CHANNELS; sample += LINE_BYTES / sizeof(FRAME)) {
      global FRAME* ahead = out + TILES_AHEAD * TILE_WIDTH * CHANNELS + sample;
      __builtin_prefetch((const void*)(size_t)ahead, /* for writing */ 1);
    }
#endif
    floats code[PLANES];
    load_codes(texels + TILE_ROWS * NEUTRAL_ROW_BYTES + row * CODE_ROW_BYTES, lane, code);
    global const NEUTRAL* stored = (global const NEUTRAL*)(texels + row * NEUTRAL_ROW_BYTES) + lane;
    results value[CHANNELS];
#pragma unroll
    for (int c = 0; c < CHANNELS; ++c) {
      const floats neutral = TO_FLOATS(*(global const neutrals*)(stored + 16 * c)) * NEUTRAL_STEP;
      floats sum = START(neutral);
#pragma unroll
      for (int i = 0; i < DIFFERENCES; ++i) {
        sum = fma(DIFFERENCE(code[c * DIFFERENCES + i], i * CHANNELS + c), w[i], sum);
      }
      value[c] = finish(neutral, sum);
    }
    store(out, value);
    out += (ulong)tiles_x * (TILE_WIDTH * CHANNELS);
  }
}
