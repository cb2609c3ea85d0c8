// bc7_fit.h - lines with ends and steps that BC7 can code. Included after block_line.h.
// Defines  ROUNDS  times that ends are fitted to indices and indices to ends
//          NEARBY  1: of the two steps beside a texel the one that decodes nearer is taken; 0: the nearer one
//          SWEEPS  times that every end is moved by a step of its code, in every channel, and stays where that helped
#ifndef FACEZIP_BC7_FIT_H
#define FACEZIP_BC7_FIT_H

// How the ends of one line are coded, each lane's its own: e in 0..top, of which the lowest bit is the p-bit where there is
// one, becomes the value e * widen + floor(e * fold); between the ends are `levels` steps.
typedef struct {
  floats steps, top, widen, fold, levels, to64;
  floats stride, inverse;  // from code to code with the same p-bit: 2 with p-bits, else 1
  ints shared;    // both ends have the same p-bit
} Coding;

// bits     of e
// p_bits   0 none, 1 one that both ends share, 2 one each
inline Coding coding_of(const ints bits, const ints p_bits, const ints index_bits) {
  Coding coding;
  coding.top = TO_FLOATS(((ints)(1) << bits) - 1);
  coding.steps = coding.top * (1.0f / 255.0f);
  coding.widen = TO_FLOATS((ints)(1) << (8 - bits));
  coding.fold = coding.widen / TO_FLOATS((ints)(1) << bits);
  coding.levels = TO_FLOATS(((ints)(1) << index_bits) - 1);
  coding.to64 = 64.0f / coding.levels;
  coding.stride = p_bits > 0 ? (floats)(2.0f) : (floats)(1.0f);
  coding.inverse = 1.0f / coding.stride;
  coding.shared = p_bits == 1;
  return coding;
}

// The value that can be coded, with that p-bit, next to `value`.
inline floats codeable(const Coding coding, const floats value, const floats p) {
  const floats e = NEAREST((value * coding.steps - p) * coding.inverse) * coding.stride + p;
  const floats low = coding.stride > 1.0f ? p : (floats)(0.0f);
  const floats code = min(max(e, low), coding.top - (coding.stride - 1.0f) + low);
  return code * coding.widen + NEAREST(code * coding.fold - 0.498f);
}

// A line from one end to the other, less the mean, and the p-bits of its ends.
typedef struct {
  floats ends[2][DIMS];
  floats p[2];
} Line;

inline void take_line(const ints where, const Line from, Line* to) {
#pragma unroll
  for (int side = 0; side < 2; ++side) {
    to->p[side] = where ? from.p[side] : to->p[side];
#pragma unroll
    for (int k = 0; k < DIMS; ++k) to->ends[side][k] = where ? from.ends[side][k] : to->ends[side][k];
  }
}

// With neighbours to be tried, an index is rounded down.
inline Steps steps_between(const Coding coding, const floats scale[DIMS], const floats ends[2][DIMS]) {
  return steps_of(coding.levels, NEARBY ? -0.5f : 0.0f, scale, ends);
}

inline floats decoded_channel(const Steps steps, const floats step, const int k) {
  return NEAREST(step * steps.span[k] + steps.start[k]);
}

inline floats decoding_error(const Steps steps, const floats scale[DIMS], const floats step, const floats texel[DIMS]) {
  floats error = 0.0f;
#pragma unroll
  for (int k = 0; k < DIMS; ++k) {
    const floats rest = texel[k] - decoded_channel(steps, step, k);
    error += scale[k] * rest * rest;
  }
  return error;
}

inline floats step_of_index(const Coding coding, const floats index) {
  return NEAREST(index * coding.to64) * (1.0f / 64.0f);
}

// The index of a texel; its step, from 0 to 1, and the error that it leaves.
inline floats nearest_index(const Coding coding, const Steps steps, const floats scale[DIMS], const floats texel[DIMS],
                            floats* step, floats* error) {
  floats at = steps.offset;
#pragma unroll
  for (int k = 0; k < DIMS; ++k) at += steps.along[k] * texel[k];
  const floats last = NEARBY ? coding.levels - 1.0f : coding.levels;
  floats index = min(max(NEAREST(at), (floats)(0.0f)), last);
  *step = step_of_index(coding, index);
  *error = decoding_error(steps, scale, *step, texel);
#if NEARBY
  const floats next = step_of_index(coding, index + 1.0f);
  const floats next_error = decoding_error(steps, scale, next, texel);
  const ints nearer = next_error < *error;
  index = nearer ? index + 1.0f : index;
  *step = nearer ? next : *step;
  *error = min(*error, next_error);
#endif
  return index;
}

inline StepSums assign(const Coding coding, const floats* x, const floats* w, const floats scale[DIMS],
                       const floats ends[2][DIMS]) {
  const Steps steps = steps_between(coding, scale, ends);
  StepSums sums;
  sums.s = sums.ss = sums.error = 0.0f;
#pragma unroll
  for (int k = 0; k < DIMS; ++k) sums.sx[k] = 0.0f;
  for (int t = 0; t < 16; ++t) {
    floats texel[DIMS];
#pragma unroll
    for (int k = 0; k < DIMS; ++k) texel[k] = TEXEL_OF(x, k, t);
    floats step, error;
    nearest_index(coding, steps, scale, texel, &step, &error);
    const floats weighted = w[t] * step;
    sums.s += weighted;
    sums.ss += weighted * step;
#pragma unroll
    for (int k = 0; k < DIMS; ++k) sums.sx[k] += weighted * texel[k];
    sums.error += w[t] * error;
  }
  return sums;
}

// The best ends for the steps of `steps`, as codes: the first makes up for the rounding of the second (Babai's nearest
// plane), under every choice of p-bits.
inline void fit_ends(const Coding coding, const StepSums steps, const TexelSums sums, const floats mean[DIMS],
                     const floats scale[DIMS], Line* line) {
  const EndSystem system = solve_ends(steps, sums);
  const floats share = system.b / max(system.a, (floats)(1e-6f));
  floats least = LARGEST;
  for (int bits = 0; bits < 4; ++bits) {
    const floats first_bit = (float)(bits & 1);
    const floats second_bit = (float)(bits >> 1);
    floats cost = coding.shared && first_bit != second_bit ? (floats)(LARGEST / 2) : (floats)(0.0f);
    Line trial;
    trial.p[0] = first_bit;
    trial.p[1] = second_bit;
#pragma unroll
    for (int k = 0; k < DIMS; ++k) {
      trial.ends[1][k] = codeable(coding, system.ideal[1][k] + mean[k], second_bit) - mean[k];
      const floats second = trial.ends[1][k] - system.ideal[1][k];
      trial.ends[0][k] = codeable(coding, system.ideal[0][k] - share * second + mean[k], first_bit) - mean[k];
      const floats first = trial.ends[0][k] - system.ideal[0][k];
      cost += scale[k] * (system.a * first * first + 2.0f * system.b * first * second + system.c * second * second);
    }
    const ints better = cost < least;
    least = better ? cost : least;
    take_line(better, trial, line);
  }
}

#if SWEEPS > 0
// Moves the ends by single steps of their code, where that helps.
inline floats sweep_ends(const Coding coding, const floats* x, const floats* w, const floats mean[DIMS],
                         const floats scale[DIMS], floats least, Line* line) {
  const floats stride = coding.stride * 255.0f / coding.top;
  for (int sweep = 0; sweep < SWEEPS; ++sweep) {
    for (int move = 0; move < 4 * DIMS; ++move) {
      const int channel = move >> 2;
      const int side = move & 1;
      const floats by = move & 2 ? stride : -stride;
      Line trial = *line;
      const floats from = line->ends[side][channel] + mean[channel];
      trial.ends[side][channel] = codeable(coding, from + by, line->p[side]) - mean[channel];
      const floats error = assign(coding, x, w, scale, trial.ends).error;
      const ints better = error < least;
      least = better ? error : least;
      line->ends[side][channel] = better ? trial.ends[side][channel] : line->ends[side][channel];
    }
  }
  return least;
}
#endif

// Fits a line to the texels with weights w; returns its error, and the values of its ends, mean included.
inline floats fit_line(const Coding coding, const floats* x, const floats* w, const floats mean[DIMS],
                       const floats scale[DIMS], floats values[2][DIMS]) {
  const TexelSums sums = sum_texels(x, w);
  Line line;
  line.p[0] = line.p[1] = 0.0f;
  first_ends(x, w, scale, sums, line.ends);
  Line best = line;
  floats least = LARGEST;
  StepSums steps = assign(coding, x, w, scale, line.ends);
  for (int round = 0; round < ROUNDS; ++round) {
    fit_ends(coding, steps, sums, mean, scale, &line);
    steps = assign(coding, x, w, scale, line.ends);
    const ints better = steps.error < least;
    least = better ? steps.error : least;
    take_line(better, line, &best);
  }
#if SWEEPS > 0
  least = sweep_ends(coding, x, w, mean, scale, least, &best);
#endif
#pragma unroll
  for (int k = 0; k < DIMS; ++k) {
    values[0][k] = best.ends[0][k] + mean[k];
    values[1][k] = best.ends[1][k] + mean[k];
  }
  return least;
}

#endif
