#version 330
// Compiles facezip_blend.h as GLSL, as an engine would use it.
uniform float fz_beta[20];
#include "facezip_blend.h"
uniform sampler2D neutral;
uniform sampler2DArray differences;
uniform sampler2DArray weights;
uniform sampler2D grid;
uniform vec4 zero[FZ_DIFFERENCES];
uniform vec4 scale[FZ_DIFFERENCES];
uniform bool one_pass;
in vec2 uv;
out vec4 colour;
void main() {
  vec2 cells = vec2(128.0, 128.0);
  vec2 cell = fz_cell(uv, vec2(1024.0, 1024.0), 8.0, cells);
  vec4 none = vec4(0.0, 0.0, 0.0, 0.0);
  vec4 low = one_pass ? fz_weights_in_one_pass(weights, cell, cells, 20, 1, 0, zero[0], none)
                      : fz_weights(grid, cell, cells, 0);
  vec4 pass_1 = fz_blend_weights(weights, ivec2(cell), 20, 1, 0, zero[0], none, 1.0);
  colour = texture(neutral, uv) + fz_difference(differences, uv, low, none, zero, scale) + 0.0 * pass_1;
}
