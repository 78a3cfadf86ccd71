/* Text with _{below} and ^{above} on a cairo context. */
#pragma once

#include <stddef.h>

/* cairo_t, so that this header compiles without cairo's include path. */
struct _cairo;

/* Width in user units at the size given. */
double scree_text_width(struct _cairo *cr, const char *text, double size);

/* Draws with the anchor at (x, y): align 0 left, 0.5 centre, 1 right; y is the baseline. */
void scree_text_draw(struct _cairo *cr, const char *text, double size, double x, double y,
                     double align);

enum { SCREE_RUN_BYTES = 256 };
typedef struct scree_text_run {
  char text[SCREE_RUN_BYTES];
  char kind; /* 0, '_' or '^' */
} scree_text_run;
/* The first run of the text; returns what comes after it. */
const char *scree_text_run_next(const char *text, scree_text_run *run);

/* The text without its marks, for files that know none, into buffer of size bytes. */
void scree_text_plain(const char *text, char *buffer, size_t size);
