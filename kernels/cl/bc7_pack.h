// bc7_pack.h - the bits of BC7 blocks, and the texels that decoders make of them, from each lane's way of coding.
#ifndef FACEZIP_BC7_PACK_H
#define FACEZIP_BC7_PACK_H

typedef struct {
  floats error;
  ints way;                 // bc7_candidates.h
  floats values[3][2][DIMS];  // ends of the lines of subsets; with a plane of its own: colours, then [1][side][0] that plane
} Choice;

#define GATHER(name, type)                                                                   \
  inline ints name(constant const type* table, const ints at) {                              \
    ints values;                                                                             \
    for (int l = 0; l < LANES; ++l) LANE(int, values, l) = (int)table[LANE(const int, at, l)]; \
    return values;                                                                           \
  }
GATHER(gather_uchar, uchar)
GATHER(gather_ushort, ushort)
GATHER(gather_uint, uint)

// What the way of a lane says.
typedef struct {
  ints mode, partition, rotation, selector;
  ints dual, subsets, colour_bits, alpha_bits, p_bits, index_bits, second_bits;
  ints two, three;  // subsets of texels: bit t, bits 2 t and 2 t + 1
} Fields;

inline Fields fields_of(const ints way) {
  Fields fields;
  const ints family = way >> 6;
  fields.mode = family == 8 ? (ints)(4) : family;
  fields.dual = fields.mode == 4 || fields.mode == 5;
  fields.selector = family == 8 ? (ints)(1) : (ints)(0);
  fields.partition = fields.dual ? (ints)(0) : way & 63;
  fields.rotation = fields.dual ? way & 63 : (ints)(0);
  fields.subsets = gather_uchar(kSubsets, fields.mode);
  fields.colour_bits = gather_uchar(kColourBits, fields.mode);
  fields.alpha_bits = gather_uchar(kAlphaBits, fields.mode);
  fields.p_bits = gather_uchar(kPBits, fields.mode);
  fields.index_bits = gather_uchar(kIndexBits, fields.mode);
  fields.second_bits = gather_uchar(kSecondIndexBits, fields.mode);
  fields.two = fields.subsets == 2 ? gather_ushort(kTwoSubsets, fields.partition) : (ints)(0);
  fields.three = fields.subsets == 3 ? gather_uint(kThreeSubsets, fields.partition) : (ints)(0);
  return fields;
}

// Whether any lane has that subset or plane.
inline bool has_part(const Fields fields, const int part) {
  return part == 0 || ANY(fields.subsets > part || (part == 1 && fields.dual));
}

inline ints subset_of(const Fields fields, const int t) { return ((fields.two >> t) & 1) | ((fields.three >> (2 * t)) & 3); }

// Coding of a subset's line, or of plane 0 (colours) or 1.
inline Coding part_coding(const Fields fields, const int part) {
  const ints second = part == 1 ? fields.dual : (ints)(0);
  const ints p = fields.p_bits > 0 ? (ints)(1) : (ints)(0);
  const ints bits = second ? fields.alpha_bits : fields.colour_bits + p;
  // The selector swaps which plane has the finer indices.
  const ints finer = fields.dual && (second ? fields.selector == 0 : fields.selector == 1);
  return coding_of(bits, fields.p_bits, finer ? fields.second_bits : fields.index_bits);
}

// The channel that is a plane of its own.
#define ALONE(rotation, array) ((rotation) == 1 ? (array)[0] : (rotation) == 2 ? (array)[1] : (rotation) == 3 ? (array)[2] : (array)[DIMS - 1])

// Texels, means and weights of one part: a subset keeps them; plane 0 has alpha in place of the channel that is alone
// (weightless where there is no alpha), plane 1 that channel in the first place. Opaque modes code no alpha.
inline void part_texels(const Fields fields, const int part, const floats* x, const floats* w, const floats mean[DIMS],
                        const floats scale[DIMS], floats* y, floats* weights, floats part_mean[DIMS],
                        floats part_scale[DIMS]) {
  const floats zero = 0.0f;
  const ints second = part == 1 ? fields.dual : (ints)(0);
#pragma unroll
  for (int k = 0; k < DIMS; ++k) {
    const ints swapped = fields.dual && (fields.rotation == k + 1 || k == 3);
    const floats first_mean = swapped ? (DIMS == 4 && k < 3 ? mean[DIMS - 1] : zero) : mean[k];
    const floats first_scale = swapped ? (DIMS == 4 && k < 3 ? scale[DIMS - 1] : zero) : scale[k];
    part_mean[k] = second ? (k == 0 ? ALONE(fields.rotation, mean) : zero) : first_mean;
    part_scale[k] = second ? (k == 0 ? ALONE(fields.rotation, scale) : zero) : first_scale;
    if (k == 3) part_scale[k] = fields.mode < 4 ? zero : part_scale[k];
  }
  for (int t = 0; t < 16; ++t) {
    floats texel[DIMS];
#pragma unroll
    for (int k = 0; k < DIMS; ++k) texel[k] = TEXEL_OF(x, k, t);
#pragma unroll
    for (int k = 0; k < DIMS; ++k) {
      const ints swapped = fields.dual && (fields.rotation == k + 1 || k == 3);
      const floats first = swapped ? (DIMS == 4 && k < 3 ? texel[DIMS - 1] : zero) : texel[k];
      TEXEL_OF(y, k, t) = second ? (k == 0 ? ALONE(fields.rotation, texel) : zero) : first;
    }
    weights[t] = fields.dual || subset_of(fields, t) == part ? w[t] : zero;
  }
}

// Indices of the texels, those of plane 1 in `second`, and the decoded texels, mean included.
inline void find_indices(const Choice choice, const Fields fields, const floats* x, const floats* w, const floats mean[DIMS],
                         const floats scale[DIMS], ints index[16], ints second[16], floats* result) {
  for (int part = 0; part < 3; ++part) {
    if (!has_part(fields, part)) continue;
    floats y[16 * DIMS], weights[16], part_mean[DIMS], part_scale[DIMS], ends[2][DIMS];
    part_texels(fields, part, x, w, mean, scale, y, weights, part_mean, part_scale);
    const Coding coding = part_coding(fields, part);
#pragma unroll
    for (int k = 0; k < DIMS; ++k) {
      ends[0][k] = choice.values[part][0][k] - part_mean[k];
      ends[1][k] = choice.values[part][1][k] - part_mean[k];
    }
    const Steps steps = steps_between(coding, part_scale, ends);
    const ints plane = part == 1 ? fields.dual : (ints)(0);
    for (int t = 0; t < 16; ++t) {
      floats texel[DIMS];
#pragma unroll
      for (int k = 0; k < DIMS; ++k) texel[k] = TEXEL_OF(y, k, t);
      floats step, error;
      const ints found = TO_INTS(nearest_index(coding, steps, part_scale, texel, &step, &error));
      const ints own = fields.dual ? (ints)(part == 0 ? -1 : 0) : subset_of(fields, t) == part;
      index[t] = own ? found : (part == 0 ? (ints)(0) : index[t]);
      second[t] = plane ? found : (part == 0 ? (ints)(0) : second[t]);
      floats value[DIMS];
#pragma unroll
      for (int k = 0; k < DIMS; ++k) value[k] = decoded_channel(steps, step, k) + part_mean[k];
#pragma unroll
      for (int k = 0; k < DIMS; ++k) {
        const ints alone = fields.rotation == (k + 1) % 4;
        // Plane 0 holds alpha where the lonely channel was.
        const floats swapped = k == 3 ? ALONE(fields.rotation, value) : value[k];
        const ints mine = own && !(fields.dual && alone);
        const floats before = part == 0 ? (floats)(0.0f) : TEXEL_OF(result, k, t);
        const floats opaque = k == 3 ? (fields.mode < 4 ? (floats)(255.0f) : swapped) : swapped;
        TEXEL_OF(result, k, t) = mine ? opaque : plane && alone ? value[0] : before;
      }
    }
  }
}

// 128 bits, filled from the lowest up, in each lane its own number at a time.
typedef struct {
  uints words[4];
  ints at;
} Bits;

inline void put(Bits* bits, const ints value, const ints count) {
  const uints field = AS_UINTS(count > 0 ? value : (ints)(0));
  const ints word = bits->at >> 5;
  const uints shift = AS_UINTS(bits->at & 31);
  const uints low = field << shift;
  const uints high = (field >> 1) >> (31u - shift);
#pragma unroll
  for (int k = 0; k < 4; ++k) {
    bits->words[k] |= word == k ? low : (uints)(0u);
    if (k > 0) bits->words[k] |= word == k - 1 ? high : (uints)(0u);
  }
  bits->at += count;
}

// Ends of a line as codes.
typedef struct {
  ints colour[2][4];  // without p-bit
  ints p[2];
} Ends;

inline void swap_where(const ints condition, ints* a, ints* b) {
  const ints keep = *a;
  *a = condition ? *b : keep;
  *b = condition ? keep : *b;
}

inline Ends ends_of(const Choice choice, const Fields fields, const int part) {
  Ends ends;
  const ints has_p = fields.p_bits > 0;
  const ints drop = 8 - fields.colour_bits - (has_p ? (ints)(1) : (ints)(0));
  for (int side = 0; side < 2; ++side) {
    ints code[4];
    for (int k = 0; k < 3; ++k) {
      // Where there is no alpha to code: opaque.
      const ints none = DIMS == 3 ? fields.dual && fields.rotation == k + 1 : (ints)(0);
      code[k] = (none ? (ints)(255) : TO_INTS(choice.values[part][side][k])) >> drop;
    }
    code[3] = DIMS == 4 ? TO_INTS(choice.values[part][side][DIMS - 1]) >> drop : (ints)(255);
    ends.p[side] = has_p ? code[0] & 1 : (ints)(0);
    for (int k = 0; k < 4; ++k) ends.colour[side][k] = has_p ? code[k] >> 1 : code[k];
    const ints own_plane = TO_INTS(choice.values[1][side][0]) >> (8 - fields.alpha_bits);
    ends.colour[side][3] = fields.dual ? own_plane : ends.colour[side][3];
    ends.colour[side][3] &= ((ints)(1) << fields.alpha_bits) - 1;
  }
  return ends;
}

// Packs blocks. index, second are changed: the first index of every subset has no highest bit, so its ends swap where it
// had one.
inline void pack(const Choice choice, const Fields fields, ints index[16], ints second[16], uints words[4]) {
  const ints pair = gather_uchar(kThreeAnchors, fields.partition);
  ints anchor[3];
  anchor[0] = 0;
  anchor[1] = fields.subsets == 2 ? gather_uchar(kSecondAnchor, fields.partition) : fields.subsets == 3 ? pair & 15 : (ints)(-1);
  anchor[2] = fields.subsets == 3 ? pair >> 4 : (ints)(-1);
  // Of mode 4 with the selector, colours have the finer indices.
  const ints bits_of_first = fields.selector == 1 ? fields.second_bits : fields.index_bits;
  const ints bits_of_second = fields.selector == 1 ? fields.index_bits : fields.second_bits;
  Ends ends[3];
  for (int part = 0; part < 3; ++part) {
    ends[part] = ends_of(choice, fields, part);
    ints at_anchor = 0;
    for (int t = 0; t < 16; ++t) at_anchor = anchor[part] == t ? index[t] : at_anchor;
    const ints flip = at_anchor >= (ints)(1) << (bits_of_first - 1);
    for (int k = 0; k < 3; ++k) swap_where(flip, &ends[part].colour[0][k], &ends[part].colour[1][k]);
    swap_where(flip && !fields.dual, &ends[part].colour[0][3], &ends[part].colour[1][3]);
    swap_where(flip, &ends[part].p[0], &ends[part].p[1]);
    const ints last = ((ints)(1) << bits_of_first) - 1;
    for (int t = 0; t < 16; ++t) index[t] = flip && subset_of(fields, t) == part ? last - index[t] : index[t];
  }
  const ints flip = fields.dual && second[0] >= (ints)(1) << (bits_of_second - 1);
  swap_where(flip, &ends[0].colour[0][3], &ends[0].colour[1][3]);
  const ints last = ((ints)(1) << bits_of_second) - 1;
  for (int t = 0; t < 16; ++t) second[t] = flip ? last - second[t] : second[t];

  Bits bits;
  for (int k = 0; k < 4; ++k) bits.words[k] = 0u;
  bits.at = 0;
  const ints none = 0;
  put(&bits, (ints)(1) << fields.mode, fields.mode + 1);
  put(&bits, fields.partition, gather_uchar(kPartitionBits, fields.mode));
  put(&bits, fields.rotation, fields.dual ? (ints)(2) : none);
  put(&bits, fields.selector, fields.mode == 4 ? (ints)(1) : none);
  for (int k = 0; k < 4; ++k) {
    for (int part = 0; part < 3; ++part) {
      for (int side = 0; side < 2; ++side) {
        put(&bits, ends[part].colour[side][k], fields.subsets > part ? (k < 3 ? fields.colour_bits : fields.alpha_bits) : none);
      }
    }
  }
  for (int part = 0; part < 3; ++part) {
    for (int side = 0; side < 2; ++side) {
      put(&bits, ends[part].p[side], fields.subsets > part && fields.p_bits > side ? (ints)(1) : none);
    }
  }
  // Indices of two bits come first, whichever plane they are of.
  for (int t = 0; t < 16; ++t) {
    const ints anchored = anchor[0] == t || anchor[1] == t || anchor[2] == t;
    const ints count = fields.index_bits - (anchored ? (ints)(1) : none);
    put(&bits, fields.selector == 1 ? second[t] : index[t], count);
  }
  for (int t = 0; t < 16; ++t) {
    put(&bits, fields.selector == 1 ? index[t] : second[t], fields.dual ? fields.second_bits - (t == 0) : none);
  }
  for (int k = 0; k < 4; ++k) words[k] = bits.words[k];
}

#endif
