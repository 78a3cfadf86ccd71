/* Tables as text, by the one reader of them all: CSV, with semicolons or tabs, or with blanks
 * between; with quotes, a byte order mark, any line ends, and comments, which begin with # anywhere
 * or with % or // where a line does. The first row says what parts the others. */
#pragma once

#include "base/error.h"

enum { SCREE_ROW_CELLS = 64 };

typedef struct scree_text_rows {
  const char *name; /* of the file */
  char *rest;       /* of its text, which is cut up */
  size_t line;
  char separator; /* 0: not known yet; ' ': blanks */
  size_t count;
  char *cells[SCREE_ROW_CELLS]; /* of the row, without quotes and blanks around them */
  char *comment; /* the line is one: what stands behind its mark; NULL: it is a row */
  scree_error *error;
} scree_text_rows;

/* text: byte_count bytes and a 0 behind them; it is the caller's and stays. SCREE_BAD_FILE where it
 * is no text of UTF-8's kind. */
scree_status scree_rows_open(scree_text_rows *rows, const char *name, char *text, size_t byte_count,
                             scree_error *error);
/* The next line that is not blank; false at the end. */
scree_status scree_rows_next(scree_text_rows *rows, bool *there);
/* The next row: comments are passed over. */
scree_status scree_rows_next_row(scree_text_rows *rows, bool *there);
/* The cells of a line that stands apart, as a comment with names; it is cut up. */
scree_status scree_rows_split(scree_text_rows *rows, char *line);

/* A cell as a number with a decimal point; `what` it is is for the sentence. */
scree_status scree_rows_number(const scree_text_rows *rows, size_t cell, const char *what,
                               double *value);
/* Whether the row has a number in that cell. */
bool scree_rows_has_number(const scree_text_rows *rows, size_t cell);
/* Cuts `x [mm]` or `x (mm)` into a name and a unit, "" where there is none. */
const char *scree_cell_unit(char *cell);
/* A column that counts the rows, as pandas writes it: it has no name, or one of pandas'. */
bool scree_cell_is_index(const char *name);

/* SCREE_BAD_FILE with the file's name and the line. */
scree_status scree_rows_fail(const scree_text_rows *rows, const char *format, ...)
    SCREE_PRINTF(2, 3);
