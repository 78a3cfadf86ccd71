/* Bytes as a file that can be opened by name. */
#pragma once

#include "fuzz/fuzz.h"

#include <stdbool.h>
#include <stdio.h>
#include <sys/mman.h>
#include <unistd.h>

/* A file in memory; the caller defines _GNU_SOURCE, and closes it. */
static inline int fuzz_file(const void *bytes, size_t count, char path[64]) {
  int fd = memfd_create("fuzz", 0);
  FUZZ_CHECK(fd >= 0 && write(fd, bytes, count) == (ssize_t)count);
  snprintf(path, 64, "/proc/self/fd/%d", fd);
  return fd;
}

/* Makes a temporary file or folder beside which nothing is, in memory where the system has a place
 * for that: results are synced to disk, which is slow. */
static inline void fuzz_place(char path[64], bool is_folder) {
  static const char *const places[] = {"/dev/shm", "/tmp"};
  bool made = false;
  for (int i = 0; i < 2 && !made; i++) {
    snprintf(path, 64, "%s/scree-fuzz-XXXXXX", places[i]);
    if (is_folder) {
      made = mkdtemp(path) != NULL;
    } else {
      int fd = mkstemp(path);
      made = fd >= 0 && close(fd) == 0;
    }
  }
  FUZZ_CHECK(made);
}

static inline void fuzz_write(const char *path, const void *bytes, size_t count) {
  FILE *stream = fopen(path, "wb");
  FUZZ_CHECK(stream && fwrite(bytes, 1, count, stream) == count && fclose(stream) == 0);
}
