/* Text with _{below} and ^{above}, in runs. */
#pragma once

#include <stddef.h>

enum { SCREE_RUN_BYTES = 256 };
typedef struct scree_text_run {
  char text[SCREE_RUN_BYTES];
  char kind; /* 0, '_' or '^' */
} scree_text_run;
/* The first run of the text; returns what comes after it. */
const char *scree_text_run_next(const char *text, scree_text_run *run);

/* The text without its marks, for files that know none, into buffer of size bytes. */
void scree_text_plain(const char *text, char *buffer, size_t size);
