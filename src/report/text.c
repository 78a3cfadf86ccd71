/* Text is cut into runs at the marks _{ and ^{ and }; each run is shown by cairo's own text calls,
 * smaller and shifted inside a mark. Marks do not nest. */
#include "report/text.h"

#include "report/utf8.h"

#include <cairo.h>
#include <stdbool.h>
#include <string.h>

enum { RUN_BYTES = 256 };
static const double SMALL = 0.72, DROP = 0.22, RISE = 0.38; /* of the size */

typedef struct run {
  char text[RUN_BYTES];
  char kind; /* 0, '_' or '^' */
} run;

/* Appends one character of text to out (of size bytes, used of them taken) where it fits whole, and
 * moves text behind it. A control character has no glyph: a space stands for it; a byte that is no
 * UTF-8 becomes U+FFFD. Returns false where it does not fit. */
static bool put(char *out, size_t *used, size_t size, const char **text) {
  size_t length = scree_utf8_length(*text), step = length ? length : 1;
  const char *from = length ? *text : "\ufffd";
  if (length == 0) length = strlen(from);
  if (length == 1 && (unsigned char)*from < 0x20) from = " ";
  if (*used + length >= size) return false;
  memcpy(out + *used, from, length);
  *used += length;
  *text += step;
  return true;
}

static bool at_mark(const char *text) {
  return (*text == '_' || *text == '^') && text[1] == '{' && strchr(text, '}');
}

static const char *next_run(const char *text, run *r) {
  size_t used = 0;
  r->kind = 0;
  if (at_mark(text)) {
    r->kind = *text;
    text += 2;
  }
  while (*text) {
    if (r->kind && *text == '}') {
      text++;
      break;
    }
    if (!r->kind && at_mark(text)) break;
    if (!put(r->text, &used, RUN_BYTES, &text)) break; /* the rest comes in the next run */
  }
  r->text[used] = 0;
  return text;
}

static double show(cairo_t *cr, const char *text, double size, double x, double y, int draw) {
  double start = x;
  run r;
  while (*text) {
    text = next_run(text, &r);
    cairo_set_font_size(cr, r.kind ? SMALL * size : size);
    cairo_text_extents_t extents;
    cairo_text_extents(cr, r.text, &extents);
    if (draw) {
      cairo_move_to(cr, x, y + (r.kind == '_' ? DROP * size : r.kind == '^' ? -RISE * size : 0));
      cairo_show_text(cr, r.text);
    }
    x += extents.x_advance;
  }
  return x - start;
}

double scree_text_width(cairo_t *cr, const char *text, double size) {
  return show(cr, text, size, 0, 0, 0);
}

void scree_text_draw(cairo_t *cr, const char *text, double size, double x, double y, double align) {
  if (align != 0) x -= align * scree_text_width(cr, text, size);
  show(cr, text, size, x, y, 1);
  cairo_new_path(cr);
}

void scree_text_plain(const char *text, char *buffer, size_t size) {
  size_t used = 0;
  run r;
  while (*text) {
    text = next_run(text, &r);
    if (r.kind && used + 1 < size) buffer[used++] = r.kind;
    const char *c = r.text;
    while (*c && put(buffer, &used, size, &c)) continue;
  }
  buffer[used] = 0;
}
