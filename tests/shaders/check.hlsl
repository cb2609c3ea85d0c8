// Compiles facezip_blend.h as HLSL, as an engine would use it.
#define FACEZIP_HLSL
float4 fz_beta_packed[20];
#define FZ_BETA(n) fz_beta_packed[n].x
SamplerState fz_sampler;
#include "facezip_blend.h"
Texture2D<float4> neutral;
Texture2DArray<float4> differences;
Texture2DArray<float4> weights;
Texture2D<float4> grid;
float4 zero[FZ_DIFFERENCES];
float4 scale[FZ_DIFFERENCES];
bool one_pass;
float4 main(float2 uv : TEXCOORD0) : SV_Target {
  float2 cells = float2(128.0, 128.0);
  float2 cell = fz_cell(uv, float2(1024.0, 1024.0), 8.0, cells);
  float4 none = float4(0.0, 0.0, 0.0, 0.0);
  float4 low = one_pass ? fz_weights_in_one_pass(weights, cell, cells, 20, 1, 0, zero[0], none)
                        : fz_weights(grid, cell, cells, 0);
  float4 pass_1 = fz_blend_weights(weights, int2(cell), 20, 1, 0, zero[0], none, 1.0);
  return neutral.Sample(fz_sampler, uv) + fz_difference(differences, uv, low, none, zero, scale) + 0.0 * pass_1;
}
