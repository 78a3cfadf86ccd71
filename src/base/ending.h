/* How words and file names end. */
#ifndef SCREE_BASE_ENDING_H
#define SCREE_BASE_ENDING_H

#include <stdbool.h>
#include <string.h>

static inline bool scree_ends_with(const char *text, const char *ending) {
  size_t length = strlen(text), tail = strlen(ending);
  return length >= tail && !strcmp(text + length - tail, ending);
}

#endif
