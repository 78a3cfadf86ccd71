/* Paths in buffers of their callers. */
#pragma once

#include <stdbool.h>
#include <stdio.h>
#include <string.h>

/* More than any system takes: a path that is cut off here is refused by it. */
enum { SCREE_PATH_BYTES = 4200 };

static inline const char *scree_path_put(char path[SCREE_PATH_BYTES], const char *folder,
                                         const char *name) {
  snprintf(path, SCREE_PATH_BYTES, "%s/%s", folder, name);
  return path;
}
/* FOLDER/NAME, until the end of the block. */
#define SCREE_PATH_IN(folder, name) scree_path_put((char[SCREE_PATH_BYTES]){0}, folder, name)

/* How words and file names end. */
static inline bool scree_ends_with(const char *text, const char *ending) {
  size_t length = strlen(text), tail = strlen(ending);
  return length >= tail && !strcmp(text + length - tail, ending);
}
