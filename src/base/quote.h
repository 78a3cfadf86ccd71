/* Text for other programs: names of files, shapes and sensors may hold any byte. All that is
 * written for another program goes through here; quote.c has a row for each of their languages.
 * What reads it gets the text back, but for what a language cannot say: a byte that is no UTF-8 is
 * U+FFFD there. The shell alone takes all bytes as they are. */
#pragma once

#include "base/error.h"

#include <stddef.h>

typedef enum scree_quoting {
  SCREE_QUOTE_JSON,    /* "...", also safe in an HTML script element */
  SCREE_QUOTE_YAML,    /* "...", or bare where no reader of YAML takes it for anything but text */
  SCREE_QUOTE_CSV,     /* RFC 4180: "...", or bare */
  SCREE_QUOTE_XML,     /* of an element or between double quotes; SVG and VTK are XML */
  SCREE_QUOTE_HTML,    /* likewise; line ends stay */
  SCREE_QUOTE_SHELL,   /* one word of a POSIX shell */
  SCREE_QUOTE_GNUPLOT, /* '...': a file's name; control characters are blanks */
  SCREE_QUOTE_GNUPLOT_LABEL, /* within '...': enhanced text that means what it says; likewise */
  SCREE_QUOTE_COMMENT, /* the rest of a line of any of them; a line end is a blank, a backslash a
                          slash */
  SCREE_QUOTE_NAME,    /* letters, digits, points, - and _, which mean nothing to LAMMPS, LIGGGHTS,
                          YADE, PFC, Chrono, EDEM and MFiX; the others are _ */
  SCREE_QUOTING_COUNT
} scree_quoting;

void scree_quote(FILE *stream, scree_quoting quoting, const char *text);
/* The same into a text of `size` bytes, cut between characters where it does not fit; returns it.
 */
const char *scree_quote_text(scree_quoting quoting, const char *text, char *quoted, size_t size);
/* The same in a text of its own, to be freed; NULL: out of memory. */
char *scree_quoted(scree_quoting quoting, const char *text);

/* ---- file names are bytes; JSON and pictures want UTF-8 ---- */

/* The length in bytes of the UTF-8 character at text (not at its end), 0 where there is none: stray
 * or missing bytes, overlong forms, surrogates, values above U+10FFFF. */
static inline size_t scree_utf8_length(const char *text) {
  const unsigned char *t = (const unsigned char *)text;
  if (t[0] < 0x80) return 1;
  size_t length = t[0] >= 0xc2 && t[0] <= 0xdf ? 2 : (t[0] & 0xf0) == 0xe0 ? 3 : 4;
  if (length == 4 && (t[0] < 0xf0 || t[0] > 0xf4)) return 0;
  for (size_t i = 1; i < length; i++)
    if ((t[i] & 0xc0) != 0x80) return 0;
  if (t[0] == 0xe0 && t[1] < 0xa0) return 0;
  if (t[0] == 0xed && t[1] > 0x9f) return 0;
  if (t[0] == 0xf0 && t[1] < 0x90) return 0;
  if (t[0] == 0xf4 && t[1] > 0x8f) return 0;
  return length;
}
