/* A folder of a target's own, removed with all that is in it when the target ends. The caller
 * defines _GNU_SOURCE. */
#pragma once

#include "fuzz/files.h"

#include <ftw.h>

static char fuzz_folder[64];

static inline int fuzz_remove_one(const char *path, const struct stat *info, int type,
                                  struct FTW *place) {
  (void)info, (void)type, (void)place;
  return remove(path);
}

static inline void fuzz_remove_folder(void) {
  nftw(fuzz_folder, fuzz_remove_one, 8, FTW_DEPTH | FTW_PHYS);
}

static inline void fuzz_make_folder(void) {
  fuzz_place(fuzz_folder, true);
  atexit(fuzz_remove_folder);
}

/* The path of a name in the folder; good until the next call. */
static inline const char *fuzz_in_folder(const char *name) {
  static char path[128];
  snprintf(path, sizeof path, "%s/%s", fuzz_folder, name);
  return path;
}
