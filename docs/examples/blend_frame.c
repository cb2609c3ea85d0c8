/* blend_frame - blends one frame of a package's first map, from C, and writes it as a PPM picture.
 *
 *   blend_frame PACKAGE FRAME.ppm EXPRESSION=WEIGHT...
 *
 * A game would keep the package and the frame, and call facezip_set_weights and facezip_blend each time the face moves. */
#include <facezip/facezip_runtime.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int fail(const char* what) {
  fprintf(stderr, "%s\n", what);
  return 1;
}

/* Sets the weight that "smile_open=0.7" names. Other names of a blendshape are understood: mouthSmileLeft, AU12. */
static int read_weight(const facezip_package* face, const char* argument, float* weights) {
  char name[256];
  const char* equals = strchr(argument, '=');
  if (equals == NULL || (size_t)(equals - argument) >= sizeof(name)) return 0;
  memcpy(name, argument, (size_t)(equals - argument));
  name[equals - argument] = '\0';
  int32_t expression = facezip_find_expression(face, name);
  if (expression < 0) return 0;
  weights[expression] = strtof(equals + 1, NULL);
  return 1;
}

static int write_ppm(const char* path, const facezip_map_info* map, const unsigned char* frame) {
  FILE* file = fopen(path, "wb");
  if (file == NULL) return 0;
  fprintf(file, "P6\n%d %d\n255\n", (int)map->width, (int)map->height);
  int written = fwrite(frame, 1, map->frame_bytes, file) == map->frame_bytes;
  return fclose(file) == 0 && written;
}

int main(int argc, char** argv) {
  if (argc < 3) return fail("usage: blend_frame PACKAGE FRAME.ppm EXPRESSION=WEIGHT...");
  facezip_package* face = NULL;
  if (facezip_load(argv[1], NULL, &face) != FACEZIP_OK) return fail(facezip_last_error());
  facezip_map_info map = {.struct_size = sizeof(map)};
  facezip_get_map_info(face, 0, &map);
  size_t count = (size_t)facezip_expression_count(face);
  float* weights = calloc(count, sizeof(float));
  unsigned char* frame = aligned_alloc(64, (map.frame_bytes + 63) / 64 * 64); /* aligned: the device writes into it */
  int failed = weights == NULL || frame == NULL;
  if (failed) fail("out of memory");
  if (!failed && (map.channels != 3 || map.sample_type != FACEZIP_UINT8)) failed = fail("the map is not 8-bit RGB");
  for (int i = 3; i < argc && !failed; ++i) {
    if (!read_weight(face, argv[i], weights)) failed = fail("weights are written EXPRESSION=WEIGHT");
  }
  if (!failed && (facezip_set_weights(face, weights, count) != FACEZIP_OK ||
                  facezip_blend(face, 0, frame, map.frame_bytes) != FACEZIP_OK)) {
    failed = fail(facezip_last_error());
  }
  if (!failed && !write_ppm(argv[2], &map, frame)) failed = fail("the picture cannot be written");
  free(frame);
  free(weights);
  facezip_free(face);
  return failed;
}
