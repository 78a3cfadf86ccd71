/* Each run is shown by cairo's own text calls, smaller and shifted inside a mark. */
#include "report/text.h"

#include <cairo.h>

static const double SMALL = 0.72, DROP = 0.22, RISE = 0.38; /* of the size */

static double show(cairo_t *cr, const char *text, double size, double x, double y, int draw) {
  double start = x;
  scree_text_run r;
  while (*text) {
    text = scree_text_run_next(text, &r);
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
