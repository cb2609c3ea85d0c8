/* The C interface from C, on the worked example of docs/package_format.md: facezip_runtime_test PACKAGE */
#include <facezip/facezip_runtime.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int g_failures = 0;

static void check(int holds, const char* text, int line) {
  if (holds) return;
  fprintf(stderr, "line %d: %s; last error: %s\n", line, text, facezip_last_error());
  ++g_failures;
}
#define CHECK(condition) check((condition) != 0, #condition, __LINE__)

/* A call that must fail with `status` and say `word`. */
static void check_fails(facezip_status got, facezip_status status, const char* word, int line) {
  check(got == status, "another status was expected", line);
  check(strstr(facezip_last_error(), word) != NULL, word, line);
}
#define CHECK_FAILS(call, status, word) check_fails((call), (status), (word), __LINE__)

static void check_albedo(facezip_package* package) {
  static const unsigned char expected[16] = {100, 101, 102, 103, 105, 108, 111, 114,
                                             116, 119, 122, 125, 127, 128, 129, 130};
  unsigned char frame[16 * 8];
  int x, y;
  CHECK(facezip_blend(package, 0, frame, sizeof(frame)) == FACEZIP_OK);
  for (y = 0; y < 8; ++y) {
    for (x = 0; x < 16; ++x) CHECK(frame[16 * y + x] == expected[x]);
  }
}

static void check_neutral(facezip_package* package) {
  unsigned char frame[16 * 8];
  int i;
  CHECK(facezip_blend(package, 0, frame, sizeof(frame)) == FACEZIP_OK);
  for (i = 0; i < 16 * 8; ++i) CHECK(frame[i] == 100 + i % 16);
}

static void check_gloss(facezip_package* package) {
  static const unsigned char expected[4] = {99, 100, 100, 101};
  unsigned char frame[4 * 2 + 1];
  int i;
  frame[8] = 77;
  CHECK(facezip_blend(package, 1, frame, 8) == FACEZIP_OK);
  for (i = 0; i < 8; ++i) CHECK(frame[i] == expected[i % 4]);
  CHECK(frame[8] == 77);
}

static void check_description(const facezip_package* package) {
  facezip_map_info info;
  CHECK(facezip_expression_count(package) == 2);
  CHECK(strcmp(facezip_expression_name(package, 1), "jawOpen") == 0);
  CHECK(facezip_expression_name(package, 2) == NULL);
  CHECK(facezip_expression_name(package, -1) == NULL);
  CHECK(facezip_find_expression(package, "jawOpen") == 1);
  CHECK(facezip_find_expression(package, "JawOpen") == 1); /* another spelling of it */
  CHECK(facezip_find_expression(package, "jaw") == -1);
  CHECK(facezip_map_count(package) == 2);
  CHECK(facezip_find_map(package, "gloss") == 1);
  CHECK(facezip_find_map(package, "normal") == -1);
  info.struct_size = sizeof(info);
  CHECK(facezip_get_map_info(package, 0, &info) == FACEZIP_OK);
  CHECK(strcmp(info.name, "albedo") == 0 && strcmp(info.colour_space, "sRGB") == 0);
  CHECK(info.width == 16 && info.height == 8 && info.channels == 1);
  CHECK(info.sample_type == FACEZIP_UINT8 && info.frame_bytes == 128);
}

static void check_refusals(facezip_package* package) {
  const float weights[3] = {1.0f, 2.0f, 3.0f};
  const float bad[2] = {0.0f, NAN};
  unsigned char frame[128];
  facezip_map_info info;
  facezip_texture_info texture;
  texture.struct_size = sizeof(texture);
  CHECK(facezip_get_texture_info(package, 0, 1, &texture) == FACEZIP_OK && texture.bytes == 128);
  CHECK_FAILS(facezip_read_level(package, 0, 0, 0, frame, 128), FACEZIP_ERROR_ARGUMENT, "facezip_open");
  CHECK_FAILS(facezip_read_weights(package, 0, frame, 8), FACEZIP_ERROR_ARGUMENT, "facezip_open");
  info.struct_size = 1;
  CHECK_FAILS(facezip_get_map_info(package, 0, &info), FACEZIP_ERROR_ARGUMENT, "struct_size");
  CHECK_FAILS(facezip_get_map_info(package, 2, &info), FACEZIP_ERROR_ARGUMENT, "0 to 1");
  CHECK_FAILS(facezip_get_map_info(package, 0, NULL), FACEZIP_ERROR_ARGUMENT, "null");
  CHECK_FAILS(facezip_set_weights(package, weights, 3), FACEZIP_ERROR_ARGUMENT, "expected 2");
  CHECK_FAILS(facezip_set_weights(package, NULL, 2), FACEZIP_ERROR_ARGUMENT, "null");
  CHECK_FAILS(facezip_set_weights(package, bad, 2), FACEZIP_ERROR_ARGUMENT, "jawOpen");
  CHECK_FAILS(facezip_set_weights(NULL, weights, 2), FACEZIP_ERROR_ARGUMENT, "null");
  CHECK_FAILS(facezip_blend(package, -1, frame, 128), FACEZIP_ERROR_ARGUMENT, "map");
  CHECK_FAILS(facezip_blend(package, 0, frame, 127), FACEZIP_ERROR_ARGUMENT, "expected 128");
  CHECK_FAILS(facezip_blend(package, 0, NULL, 128), FACEZIP_ERROR_ARGUMENT, "null");
  CHECK_FAILS(facezip_blend(NULL, 0, frame, 128), FACEZIP_ERROR_ARGUMENT, "null");
}

/* Textures and weight maps as the package stores them, of one that is on no device. */
static void check_files(const char* directory) {
  facezip_package* package = NULL;
  facezip_texture_info texture;
  facezip_weights_info weights;
  unsigned char samples[16 * 8], codes[2 * 2 * 2];
  unsigned short wide[4 * 2];
  const float given[2] = {0.0f, 0.0f};
  int i;
  CHECK(facezip_open(directory, &package) == FACEZIP_OK);
  if (package == NULL) return;
  CHECK(facezip_map_count(package) == 2 && facezip_find_expression(package, "smile") == 0);
  texture.struct_size = sizeof(texture);
  CHECK(facezip_get_texture_info(package, 0, 0, &texture) == FACEZIP_OK);
  CHECK(strcmp(texture.format, "") == 0 && texture.vk_format == 0 && texture.dxgi_format == 0);
  CHECK(texture.width == 16 && texture.height == 8 && texture.channels == 1 && texture.sample_type == FACEZIP_UINT8);
  CHECK(texture.block_width == 1 && texture.block_height == 1 && texture.block_bytes == 1 && texture.levels == 1);
  CHECK(texture.bytes == 128 && texture.scale[0] == 1.0 && texture.offset[0] == 0.0);
  CHECK(facezip_level_bytes(package, 0, 0, 0) == 128 && facezip_level_bytes(package, 0, 0, 1) == 0);
  CHECK(facezip_level_bytes(package, 0, 3, 0) == 0 && facezip_level_bytes(NULL, 0, 0, 0) == 0);
  CHECK(facezip_read_level(package, 0, 0, 0, samples, sizeof(samples)) == FACEZIP_OK);
  for (i = 0; i < 16 * 8; ++i) CHECK(samples[i] == 100 + i % 16);
  CHECK(facezip_get_texture_info(package, 1, 2, &texture) == FACEZIP_OK);
  CHECK(texture.sample_type == FACEZIP_UINT16 && texture.scale[0] == 0.00390625 && texture.offset[0] == 0.0);
  CHECK(facezip_read_level(package, 1, 2, 0, wide, sizeof(wide)) == FACEZIP_OK);
  for (i = 0; i < 8; ++i) CHECK(wide[i] == 20000 + 300 * (i % 4));
  weights.struct_size = sizeof(weights);
  CHECK(facezip_get_weights_info(package, 0, &weights) == FACEZIP_OK);
  CHECK(weights.set == 0 && weights.columns == 2 && weights.rows == 1 && weights.channels == 2);
  CHECK(weights.weight_scale == 8 && weights.bytes == sizeof(codes) && weights.offset[1] == -1.0);
  CHECK(facezip_read_weights(package, 0, codes, sizeof(codes)) == FACEZIP_OK);
  {
    static const unsigned char expected[8] = {255, 128, 0, 128, 0, 192, 255, 64};
    for (i = 0; i < 8; ++i) CHECK(codes[i] == expected[i]);
  }
  CHECK_FAILS(facezip_get_texture_info(package, 0, 3, &texture), FACEZIP_ERROR_ARGUMENT, "texture: expected 0 to 2");
  CHECK_FAILS(facezip_get_texture_info(package, 0, -1, &texture), FACEZIP_ERROR_ARGUMENT, "texture");
  CHECK_FAILS(facezip_get_texture_info(package, 2, 0, &texture), FACEZIP_ERROR_ARGUMENT, "map");
  CHECK_FAILS(facezip_get_texture_info(package, 0, 0, NULL), FACEZIP_ERROR_ARGUMENT, "null");
  texture.struct_size = weights.struct_size = 1;
  CHECK_FAILS(facezip_get_texture_info(package, 0, 0, &texture), FACEZIP_ERROR_ARGUMENT, "struct_size");
  CHECK_FAILS(facezip_get_weights_info(package, 0, &weights), FACEZIP_ERROR_ARGUMENT, "struct_size");
  CHECK_FAILS(facezip_read_level(package, 0, 0, 1, samples, 128), FACEZIP_ERROR_ARGUMENT, "level: expected 0 to 0");
  CHECK_FAILS(facezip_read_level(package, 0, 0, 0, samples, 127), FACEZIP_ERROR_ARGUMENT, "expected 128");
  CHECK_FAILS(facezip_read_level(package, 0, 0, 0, NULL, 128), FACEZIP_ERROR_ARGUMENT, "null");
  CHECK_FAILS(facezip_read_weights(package, 0, codes, 7), FACEZIP_ERROR_ARGUMENT, "expected 8");
  CHECK_FAILS(facezip_read_weights(package, 0, NULL, 8), FACEZIP_ERROR_ARGUMENT, "null");
  CHECK_FAILS(facezip_set_weights(package, given, 2), FACEZIP_ERROR_ARGUMENT, "facezip_load");
  CHECK_FAILS(facezip_blend(package, 0, samples, 128), FACEZIP_ERROR_ARGUMENT, "facezip_load");
  facezip_free(package);
  CHECK_FAILS(facezip_open("/no/such/package", &package), FACEZIP_ERROR_INPUT, "/no/such/package");
  CHECK(package == NULL);
  CHECK_FAILS(facezip_open(NULL, &package), FACEZIP_ERROR_ARGUMENT, "directory");
  CHECK_FAILS(facezip_open(directory, NULL), FACEZIP_ERROR_ARGUMENT, "null");
}

static void check_load_refusals(const char* directory) {
  facezip_package* package = (facezip_package*)&g_failures;
  CHECK_FAILS(facezip_load("/no/such/package", NULL, &package), FACEZIP_ERROR_INPUT, "/no/such/package");
  CHECK(package == NULL);
  CHECK_FAILS(facezip_load(directory, "no such device", &package), FACEZIP_ERROR_DEVICE, "no such device");
  CHECK_FAILS(facezip_load(NULL, NULL, &package), FACEZIP_ERROR_ARGUMENT, "directory");
  CHECK_FAILS(facezip_load(directory, NULL, NULL), FACEZIP_ERROR_ARGUMENT, "null");
  CHECK(facezip_expression_count(NULL) == 0 && facezip_map_count(NULL) == 0);
  CHECK(facezip_find_expression(NULL, "smile") == -1 && facezip_find_map(NULL, "albedo") == -1);
  facezip_free(NULL);
}

int main(int argc, char** argv) {
  const float weights[2] = {0.5f, 1.0f};
  const float none[2] = {0.0f, 0.0f};
  facezip_package* package = NULL;
  if (argc != 2) return 2;
  CHECK(strcmp(facezip_last_error(), "") == 0);
  CHECK(facezip_runtime_abi() == FACEZIP_RUNTIME_ABI);
  CHECK(strlen(facezip_runtime_version()) > 0);
  check_load_refusals(argv[1]);
  check_files(argv[1]);
  CHECK(facezip_load(argv[1], "cpu", &package) == FACEZIP_OK);
  if (package == NULL) return 1;
  check_description(package);
  check_neutral(package);
  CHECK(facezip_set_weights(package, weights, 2) == FACEZIP_OK);
  check_albedo(package);
  check_gloss(package);
  check_refusals(package);
  check_albedo(package); /* what was refused changed nothing */
  CHECK(facezip_set_weights(package, none, 2) == FACEZIP_OK);
  check_neutral(package);
  facezip_free(package);
  return g_failures == 0 ? 0 : 1;
}
