// A library to preload: writes what a process does to make its files last to the file FACEZIP_SYNC_LOG, a line each:
// "sync PATH" and "rename FROM TO".
#define _GNU_SOURCE
#include <dlfcn.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static void put(const char* line) {
  const char* file = getenv("FACEZIP_SYNC_LOG");
  const int log = file == NULL ? -1 : open(file, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
  if (log < 0) return;
  if (write(log, line, strlen(line)) < 0) abort();
  close(log);
}

static void putRename(const char* from, const char* to) {
  char line[2 * PATH_MAX + 16];
  snprintf(line, sizeof line, "rename %s %s\n", from, to);
  put(line);
}

int fsync(int descriptor) {
  char link[64], path[PATH_MAX], line[PATH_MAX + 16];
  snprintf(link, sizeof link, "/proc/self/fd/%d", descriptor);
  const ssize_t length = readlink(link, path, sizeof path - 1);
  path[length < 0 ? 0 : length] = '\0';
  snprintf(line, sizeof line, "sync %s\n", path);
  put(line);
  int (*original)(int) = (int (*)(int))dlsym(RTLD_NEXT, "fsync");
  return original(descriptor);
}

int rename(const char* from, const char* to) {
  putRename(from, to);
  int (*original)(const char*, const char*) = (int (*)(const char*, const char*))dlsym(RTLD_NEXT, "rename");
  return original(from, to);
}

int renameat2(int from_folder, const char* from, int to_folder, const char* to, unsigned flags) {
  putRename(from, to);
  int (*original)(int, const char*, int, const char*, unsigned) =
      (int (*)(int, const char*, int, const char*, unsigned))dlsym(RTLD_NEXT, "renameat2");
  return original(from_folder, from, to_folder, to, flags);
}
