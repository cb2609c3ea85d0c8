// facezip_blend.h - decoding and blending of a package (FaceZip, Eq. 8) in shaders; docs/blend.md says what it computes.
//
// One text for three languages: GLSL (3.30, ES 3.00 and later) as it stands, HLSL (Shader Model 4 and later) with
// FACEZIP_HLSL defined, and C++, where tests run it. Include it, or paste it.
//
//   FZ_DIFFERENCES  C, difference textures of the map; define before including                                  [4]
//   FZ_BETA(n)      blendshape weight of expression n, times its gain; define before including   [fz_beta[n]]
//   FZ_LAYERS, FZ_FETCH_LAYER(t, x, y, layer)  type of the weight maps, and a texel of one        [texture array]
//   FZ_SEPARATE_DIFFERENCES  defined: difference textures are no array, and step 3 is the includer's
//
// Textures are as package.json names them, without colour conversion, mirroring or premultiplied alpha; v = 0 is the
// first row of the file. Sampled values are 0..1: code / 255, or code / 65535.

#ifndef FZ_DIFFERENCES
#define FZ_DIFFERENCES 4
#endif
#ifndef FZ_BETA
#define FZ_BETA(n) fz_beta[n]
#endif

#if defined(FACEZIP_HLSL)
#define FZ_TEXTURE Texture2D<float4>
#define FZ_ARRAY Texture2DArray<float4>
#define FZ_FETCH(t, x, y) t.Load(int3(x, y, 0))
#ifndef FZ_FETCH_LAYER
#define FZ_FETCH_LAYER(t, x, y, layer) t.Load(int4(x, y, layer, 0))
#endif
#ifndef FZ_SAMPLE_LAYER
#define FZ_SAMPLE_LAYER(t, uv, layer) t.Sample(fz_sampler, float3(uv, layer))
#endif
#define FZ_MIX lerp
#define vec2 float2
#define vec4 float4
#define ivec2 int2
#elif !defined(FACEZIP_CPP)
#define FZ_TEXTURE sampler2D
#define FZ_ARRAY sampler2DArray
#define FZ_FETCH(t, x, y) texelFetch(t, ivec2(x, y), 0)
#ifndef FZ_FETCH_LAYER
#define FZ_FETCH_LAYER(t, x, y, layer) texelFetch(t, ivec3(x, y, layer), 0)
#endif
#ifndef FZ_SAMPLE_LAYER
#define FZ_SAMPLE_LAYER(t, uv, layer) texture(t, vec3(uv, float(layer)))
#endif
#define FZ_MIX mix
#endif
#ifndef FZ_LAYERS
#define FZ_LAYERS FZ_ARRAY
#endif

// Step 1, once a frame for every cell q of the weight grid: w_i(q) = gain(q) sum_n beta_n W_n[i](q), four i at a time.
//   layers      weight maps: layer n * groups + group holds channels 4 group .. 4 group + 3 of expression n
//   scale       of the four channels, times 255;  offset  of the four channels
vec4 fz_blend_weights(FZ_LAYERS layers, ivec2 cell, int expressions, int groups, int group, vec4 scale, vec4 offset,
                      float gain) {
  vec4 codes = vec4(0.0, 0.0, 0.0, 0.0);
  float beta_sum = 0.0;
  for (int n = 0; n < expressions; ++n) {
    float beta = FZ_BETA(n);
    if (beta != 0.0) {
      codes += FZ_FETCH_LAYER(layers, cell.x, cell.y, n * groups + group) * beta;
      beta_sum += beta;
    }
  }
  return (codes * scale + offset * beta_sum) * gain;
}

// Where uv lies in cells; cell centres are the integers.
vec2 fz_cell(vec2 uv, vec2 map_size, float weight_scale, vec2 cells) {
  vec2 cell = uv * map_size / weight_scale - vec2(0.5, 0.5);
  return clamp(cell, vec2(0.0, 0.0), cells - vec2(1.0, 1.0));
}

// Step 2, at every texel or pixel: w_i(p), bilinear between cells. A sampler would do, but interpolates in 1/256 steps.
//   grid  of step 1's results; group g stands in rows g * cells.y .. (g + 1) * cells.y - 1
vec4 fz_weights(FZ_TEXTURE grid, vec2 cell, vec2 cells, int group) {
  int x0 = int(cell.x);
  int y0 = int(cell.y);
  int x1 = min(x0 + 1, int(cells.x) - 1);
  int y1 = min(y0 + 1, int(cells.y) - 1);
  int top = group * int(cells.y);
  vec2 f = cell - vec2(float(x0), float(y0));
  vec4 above = FZ_MIX(FZ_FETCH(grid, x0, top + y0), FZ_FETCH(grid, x1, top + y0), f.x);
  vec4 below = FZ_MIX(FZ_FETCH(grid, x0, top + y1), FZ_FETCH(grid, x1, top + y1), f.x);
  return FZ_MIX(above, below, f.y);
}

// Steps 1 and 2 in one, for engines where a pass of its own is a burden: every expression in use costs four fetches.
vec4 fz_weights_in_one_pass(FZ_LAYERS layers, vec2 cell, vec2 cells, int expressions, int groups, int group, vec4 scale,
                            vec4 offset) {
  int x0 = int(cell.x);
  int y0 = int(cell.y);
  int x1 = min(x0 + 1, int(cells.x) - 1);
  int y1 = min(y0 + 1, int(cells.y) - 1);
  vec2 f = cell - vec2(float(x0), float(y0));
  vec4 codes = vec4(0.0, 0.0, 0.0, 0.0);
  float beta_sum = 0.0;
  for (int n = 0; n < expressions; ++n) {
    float beta = FZ_BETA(n);
    if (beta != 0.0) {
      int layer = n * groups + group;
      vec4 above = FZ_MIX(FZ_FETCH_LAYER(layers, x0, y0, layer), FZ_FETCH_LAYER(layers, x1, y0, layer), f.x);
      vec4 below = FZ_MIX(FZ_FETCH_LAYER(layers, x0, y1, layer), FZ_FETCH_LAYER(layers, x1, y1, layer), f.x);
      codes += FZ_MIX(above, below, f.y) * beta;
      beta_sum += beta;
    }
  }
  return codes * scale + offset * beta_sum;
}

#ifndef FZ_SEPARATE_DIFFERENCES
// Step 3: sum_i D_i(p) w_i(p) in units of full scale; T(p) is the neutral, sampled, plus this.
//   codes  layer i is difference texture i;  zero  code that means 0, as it is sampled, per channel
//   scale  what a sampled value of 1 more adds: scale of package.json * largest code / 255, per channel
//   low, high  w_0..w_3, w_4..w_7
vec4 fz_difference(FZ_ARRAY codes, vec2 uv, vec4 low, vec4 high, vec4 zero[FZ_DIFFERENCES],
                   vec4 scale[FZ_DIFFERENCES]) {
  vec4 sum = vec4(0.0, 0.0, 0.0, 0.0);
  for (int i = 0; i < FZ_DIFFERENCES; ++i) {
    float w = i < 4 ? low[i] : high[i - 4];
    sum += (FZ_SAMPLE_LAYER(codes, uv, i) - zero[i]) * scale[i] * w;
  }
  return sum;
}
#endif
