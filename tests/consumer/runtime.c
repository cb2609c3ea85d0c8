/* A program of somebody else's, in C: blends a frame with the installed run-time library. */
#include <facezip/facezip_runtime.h>
#include <stdio.h>
#include <stdlib.h>

int main(int argc, char** argv) {
  facezip_package* package = NULL;
  facezip_map_info map = {0};
  void* frame;
  facezip_status status;
  map.struct_size = sizeof(map);
  if (argc != 2 || facezip_load(argv[1], NULL, &package) != FACEZIP_OK ||
      facezip_get_map_info(package, 0, &map) != FACEZIP_OK) {
    fprintf(stderr, "%s\n", facezip_last_error());
    return 1;
  }
  frame = malloc(map.frame_bytes);
  status = facezip_blend(package, 0, frame, map.frame_bytes);
  free(frame);
  facezip_free(package);
  return status == FACEZIP_OK ? 0 : 1;
}
