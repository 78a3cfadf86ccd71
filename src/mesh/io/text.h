/* Walking through a text file token by token, and saying where something was wrong. Line ends are
 * LF, CR LF or CR; they are only counted when an error is told. Nothing is read at or beyond `end`.
 */
#pragma once

#include "base/error.h"

typedef struct scree_text {
  const char *begin, *p, *end;
  const char *name; /* of the file, for errors */
  double unit_m;    /* for the range of coordinates */
  scree_error *error;
} scree_text;

/* A word between white space: not terminated; length 0 at the end. */
typedef struct scree_token {
  const char *begin;
  size_t length;
} scree_token;

/* Skips white space, across lines. */
void scree_text_skip_space(scree_text *t);
/* Skips blanks, but no line end. */
void scree_text_skip_blanks(scree_text *t);
/* True at a line end or the end of the file. */
bool scree_text_at_line_end(const scree_text *t);
/* Goes to the start of the next line, or to the end. */
void scree_text_skip_line(scree_text *t);
/* The next word, across lines. */
scree_token scree_text_next(scree_text *t);

/* Whether the token is this lower-case word, in any case. */
bool scree_token_is(scree_token token, const char *word);

/* Reads the next number on whatever line; `what` says what it is ("the vertex count"). */
scree_status scree_text_number(scree_text *t, const char *what, double *value);
/* The same for a whole number in [low, high]. */
scree_status scree_text_integer(scree_text *t, const char *what, int64_t low, int64_t high,
                                int64_t *value);
/* The same for a coordinate in file units, finite and within scree's range; axis 0 is x. */
scree_status scree_text_coordinate(scree_text *t, int axis, double *value);
/* The same for three of them. */
scree_status scree_text_position(scree_text *t, double position[3]);

/* Fails with "NAME: line N: " before the sentence, N being the line of `at`. */
scree_status scree_text_fail(const scree_text *t, const char *at, const char *format, ...)
    SCREE_PRINTF(3, 4);
/* The word at `at`, in quotes, cut and made printable for an error; or "the end of the file". */
enum { SCREE_QUOTE_SIZE = 40 };
const char *scree_text_quote(const scree_text *t, const char *at, char quote[SCREE_QUOTE_SIZE]);
