/* What every test includes: cmocka with its prerequisites, and comparisons of doubles. */
#pragma once

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define CHECK_NEAR(got, expected, tolerance)                                                       \
  do {                                                                                             \
    double got_ = (got), expected_ = (expected), tolerance_ = (tolerance);                         \
    if (!(fabs(got_ - expected_) <= tolerance_)) {                                                 \
      print_error("%s = %.17g, expected %.17g within %g\n", #got, got_, expected_, tolerance_);    \
      fail();                                                                                      \
    }                                                                                              \
  } while (0)

#define CHECK_OK(call, error)                                                                      \
  do {                                                                                             \
    if ((call) != SCREE_OK) {                                                                      \
      print_error("%s: %s\n", #call, (error).message);                                             \
      fail();                                                                                      \
    }                                                                                              \
  } while (0)

/* The folder of real scans, or NULL (with a message) where there is none: call skip() then. */
static inline const char *scan_data_folder(void) {
  if (SCREE_SCAN_DATA[0]) return SCREE_SCAN_DATA;
  print_message("skipped: no folder of real scans (configure with -DSCREE_DATA_DIR=...)\n");
  return NULL;
}

/* Path of one of them; false (with a message) where the folder lacks it: leave it out then. */
static inline bool scan_data_path(const char *file, char *path, size_t size) {
  snprintf(path, size, "%s/%s", SCREE_SCAN_DATA, file);
  FILE *there = fopen(path, "rb");
  if (there)
    (void)fclose(there);
  else
    print_message("left out: %s is not in the folder of real scans\n", file);
  return there != NULL;
}
