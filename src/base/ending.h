/* How words and file names end. */
#pragma once

#include <stdbool.h>
#include <string.h>

static inline bool scree_ends_with(const char *text, const char *ending) {
  size_t length = strlen(text), tail = strlen(ending);
  return length >= tail && !strcmp(text + length - tail, ending);
}
