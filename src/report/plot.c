/* Layout: every panel gets an equal cell, the plotting area inside it leaves room for labels; below
 * all panels stands the legend in as many columns as fit, below it the note. Drawn in points
 * (1/72 inch), top left at the origin.
 *
 * Colours: the nine of Paul Tol's "muted" scheme, told apart by all common kinds of colour vision,
 * ordered so that neighbours differ in lightness too; each has its own marker as well, so that
 * black-and-white print works. */
#include "report/plot.h"

#include <cairo-pdf.h>
#include <cairo-svg.h>
#include <math.h>
#include <string.h>

static const double FONT = 9.5, SMALL_FONT = 8, NOTE_FONT = 6.5;  /* points */
static const double LEFT = 50, RIGHT = 14, TOP = 22, BOTTOM = 36; /* around the plotting area */
static const double MAJOR_TICK = 5, MINOR_TICK = 2.8;             /* points, inwards */
static const double LEGEND_ROW = 15, LEGEND_SAMPLE = 26, LEGEND_GAP = 18, NOTE_ROW = 10, EDGE = 6;
static const double LINE = 1.2, FAINT_LINE = 0.7, MARKER = 2.9, BIG_MARKER = 5.6;
static const double FIT_MARGIN = 0.04; /* of the fitted range, left free at either end */
static const double DEFAULT_WIDTH = 340, DEFAULT_HEIGHT = 290;

static const double PALETTE[SCREE_STYLE_COUNT][3] = {
    {0.200, 0.133, 0.533}, /* indigo */
    {0.867, 0.630, 0.200}, /* sand, darkened to stand on white */
    {0.067, 0.467, 0.200}, /* green */
    {0.800, 0.400, 0.467}, /* rose */
    {0.267, 0.600, 0.800}, /* cyan, darkened likewise */
    {0.533, 0.133, 0.333}, /* wine */
    {0.267, 0.667, 0.600}, /* teal */
    {0.600, 0.600, 0.200}, /* olive */
    {0.667, 0.267, 0.600}, /* purple */
};
static const double INK = 0.13;

typedef struct frame {
  double x, y, width, height;          /* the plotting area */
  double x_low, x_high, y_low, y_high; /* the axes' ends */
  scree_scale x_scale, y_scale;
} frame;

/* ---- texts: each run by cairo's own calls, smaller and shifted inside a mark ---- */

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

/* In user units at the size given. */
static double text_width(cairo_t *cr, const char *text, double size) {
  return show(cr, text, size, 0, 0, 0);
}

/* With the anchor at (x, y): align 0 left, 0.5 centre, 1 right; y is the baseline. */
static void text_draw(cairo_t *cr, const char *text, double size, double x, double y,
                      double align) {
  if (align != 0) x -= align * text_width(cr, text, size);
  show(cr, text, size, x, y, 1);
  cairo_new_path(cr);
}

/* ---- ranges ---- */

static void widen(double value, scree_scale scale, double *low, double *high) {
  if (!isfinite(value) || (scale == SCREE_SCALE_LOG && value <= 0)) return;
  *low = fmin(*low, value);
  *high = fmax(*high, value);
}

static void fit_range(const scree_panel *panel, bool is_y, double *low, double *high) {
  const scree_axis *axis = is_y ? &panel->y : &panel->x;
  *low = axis->minimum;
  *high = axis->maximum;
  if (*low != 0 || *high != 0) return;
  *low = INFINITY;
  *high = -INFINITY;
  for (size_t s = 0; s < panel->series_count; s++) {
    const scree_series *series = &panel->series[s];
    if (series->draw & SCREE_DRAW_UNFITTED) continue;
    for (size_t i = 0; i < series->count; i++) {
      widen(is_y ? series->y[i] : series->x[i], axis->scale, low, high);
      if (is_y && series->low) widen(series->low[i], axis->scale, low, high);
      if (is_y && series->high) widen(series->high[i], axis->scale, low, high);
    }
  }
  if (!(*low <= *high)) { /* no data: any range will do */
    *low = axis->scale == SCREE_SCALE_LOG ? 0.1 : 0;
    *high = 1;
  }
  if (axis->scale == SCREE_SCALE_LOG) {
    double factor = *low == *high ? 2 : pow(*high / *low, FIT_MARGIN);
    *low /= factor;
    *high *= factor;
  } else {
    double margin = *low == *high ? fmax(fabs(*low), 1) * 0.1 : FIT_MARGIN * (*high - *low);
    *low -= margin;
    *high += margin;
  }
}

static double position(double value, scree_scale scale, double low, double high) {
  return scale == SCREE_SCALE_LOG ? log(value / low) / log(high / low)
                                  : (value - low) / (high - low);
}
/* Far outside the area nothing is seen, but huge coordinates upset the renderers. */
static double clamp(double t) {
  return t < -4 ? -4 : t > 5 ? 5 : t;
}
static double frame_x(const frame *f, double x) {
  return f->x + f->width * clamp(position(x, f->x_scale, f->x_low, f->x_high));
}
static double frame_y(const frame *f, double y) {
  return f->y + f->height * (1 - clamp(position(y, f->y_scale, f->y_low, f->y_high)));
}
static bool drawable(const frame *f, double x, double y) {
  return isfinite(x) && isfinite(y) && (f->x_scale == SCREE_SCALE_LINEAR || x > 0) &&
         (f->y_scale == SCREE_SCALE_LINEAR || y > 0);
}

/* ---- colours and markers ---- */

static void set_color(cairo_t *cr, int style, double alpha) {
  if (style < 0) {
    cairo_set_source_rgba(cr, INK, INK, INK, alpha);
    return;
  }
  /* after nine the colours shift against the markers: 81 pairs before one comes again */
  const double *c = PALETTE[(style + style / SCREE_STYLE_COUNT) % SCREE_STYLE_COUNT];
  cairo_set_source_rgba(cr, c[0], c[1], c[2], alpha);
}

static void polygon(cairo_t *cr, double x, double y, double radius, int corners, double turn) {
  for (int i = 0; i < corners; i++) {
    double angle = turn + 2 * acos(-1) * i / corners;
    cairo_line_to(cr, x + radius * sin(angle), y - radius * cos(angle));
  }
  cairo_close_path(cr);
}

static void star(cairo_t *cr, double x, double y, double radius) {
  for (int i = 0; i < 10; i++) {
    double angle = acos(-1) * i / 5, r = i % 2 ? 0.42 * radius : radius;
    cairo_line_to(cr, x + r * sin(angle), y - r * cos(angle));
  }
  cairo_close_path(cr);
}

static void line(cairo_t *cr, double x0, double y0, double x1, double y1) {
  cairo_move_to(cr, x0, y0);
  cairo_line_to(cr, x1, y1);
}

static void strokes(cairo_t *cr, double x, double y, double r, double turn) {
  for (int i = 0; i < 2; i++) {
    double angle = turn + acos(-1) / 2 * i;
    line(cr, x - r * sin(angle), y + r * cos(angle), x + r * sin(angle), y - r * cos(angle));
  }
}

static void draw_marker(cairo_t *cr, const scree_series *series, double x, double y) {
  scree_marker marker = series->marker;
  if (marker == SCREE_MARKER_BY_STYLE)
    marker = series->style < 0 ? SCREE_MARKER_CIRCLE
                               : (scree_marker)(1 + series->style % SCREE_STYLE_COUNT);
  double pi = acos(-1), r = MARKER;
  cairo_new_path(cr);
  set_color(cr, series->style, 1);
  cairo_set_line_width(cr, 1.3);
  switch (marker) {
  case SCREE_MARKER_SQUARE:
    cairo_rectangle(cr, x - 0.88 * r, y - 0.88 * r, 1.76 * r, 1.76 * r);
    break;
  case SCREE_MARKER_TRIANGLE:
    polygon(cr, x, y, 1.25 * r, 3, 0);
    break;
  case SCREE_MARKER_TRIANGLE_DOWN:
    polygon(cr, x, y, 1.25 * r, 3, pi);
    break;
  case SCREE_MARKER_TRIANGLE_LEFT:
    polygon(cr, x, y, 1.25 * r, 3, -pi / 2);
    break;
  case SCREE_MARKER_DIAMOND:
    polygon(cr, x, y, 1.2 * r, 4, 0);
    break;
  case SCREE_MARKER_PENTAGON:
    polygon(cr, x, y, 1.1 * r, 5, 0);
    break;
  case SCREE_MARKER_PLUS:
    strokes(cr, x, y, 1.15 * r, 0);
    break;
  case SCREE_MARKER_CROSS:
    strokes(cr, x, y, 1.15 * r, pi / 4);
    break;
  case SCREE_MARKER_STAR:
    star(cr, x, y, BIG_MARKER);
    break;
  case SCREE_MARKER_RING:
    cairo_arc(cr, x, y, BIG_MARKER, 0, 2 * pi);
    break;
  case SCREE_MARKER_FRAME:
    cairo_rectangle(cr, x - BIG_MARKER, y - BIG_MARKER, 2 * BIG_MARKER, 2 * BIG_MARKER);
    break;
  default:
    cairo_arc(cr, x, y, r, 0, 2 * pi);
  }
  if (marker == SCREE_MARKER_RING || marker == SCREE_MARKER_FRAME || marker == SCREE_MARKER_PLUS ||
      marker == SCREE_MARKER_CROSS) {
    cairo_stroke(cr);
    return;
  }
  cairo_fill_preserve(cr);
  cairo_set_source_rgb(cr, 1, 1, 1);
  cairo_set_line_width(cr, 0.5);
  cairo_stroke(cr);
}

static void set_line(cairo_t *cr, const scree_series *series) {
  static const double dashes[] = {4, 3};
  bool faint = series->draw & SCREE_DRAW_FAINT;
  set_color(cr, series->style, faint ? 0.55 : 1);
  cairo_set_line_width(cr, faint ? FAINT_LINE : LINE);
  cairo_set_dash(cr, dashes, series->draw & SCREE_DRAW_DASHED ? 2 : 0, 0);
}

/* ---- series ---- */

static void draw_line(cairo_t *cr, const frame *f, const scree_series *series) {
  bool down = false;
  set_line(cr, series);
  cairo_new_path(cr);
  for (size_t i = 0; i < series->count; i++) {
    if (!drawable(f, series->x[i], series->y[i])) {
      down = false;
      continue;
    }
    double x = frame_x(f, series->x[i]), y = frame_y(f, series->y[i]);
    if (down)
      cairo_line_to(cr, x, y);
    else
      cairo_move_to(cr, x, y);
    down = true;
  }
  cairo_stroke(cr);
  cairo_set_dash(cr, NULL, 0, 0);
}

/* The lower edge of a band or bar on a log axis may be zero or below: it ends at the axis. */
static double floor_y(const frame *f, double y) {
  return f->y_scale == SCREE_SCALE_LOG && !(y > f->y_low) ? f->y + f->height : frame_y(f, y);
}

static void draw_band(cairo_t *cr, const frame *f, const scree_series *series) {
  if (!series->low || !series->high) return;
  cairo_new_path(cr);
  size_t drawn = 0;
  for (size_t i = 0; i < series->count; i++)
    if (drawable(f, series->x[i], series->high[i])) {
      cairo_line_to(cr, frame_x(f, series->x[i]), frame_y(f, series->high[i]));
      drawn++;
    }
  for (size_t i = series->count; i-- > 0;)
    if (drawable(f, series->x[i], series->high[i]) && isfinite(series->low[i]))
      cairo_line_to(cr, frame_x(f, series->x[i]), floor_y(f, series->low[i]));
  if (drawn < 2) return;
  cairo_close_path(cr);
  set_color(cr, series->style, 0.16);
  cairo_fill(cr);
}

static void draw_bars(cairo_t *cr, const frame *f, const scree_series *series) {
  if (!series->low || !series->high) return;
  set_color(cr, series->style, 1);
  cairo_set_line_width(cr, 0.9);
  for (size_t i = 0; i < series->count; i++) {
    if (!drawable(f, series->x[i], series->high[i]) || !isfinite(series->low[i])) continue;
    double x = frame_x(f, series->x[i]), top = frame_y(f, series->high[i]),
           bottom = floor_y(f, series->low[i]);
    line(cr, x, top, x, bottom);
    line(cr, x - MARKER, top, x + MARKER, top);
    line(cr, x - MARKER, bottom, x + MARKER, bottom);
  }
  cairo_stroke(cr);
}

static void draw_markers(cairo_t *cr, const frame *f, const scree_series *series) {
  for (size_t i = 0; i < series->count; i++) {
    if (!drawable(f, series->x[i], series->y[i])) continue;
    double x = frame_x(f, series->x[i]), y = frame_y(f, series->y[i]);
    bool inside =
        x >= f->x - 1 && x <= f->x + f->width + 1 && y >= f->y - 1 && y <= f->y + f->height + 1;
    if (inside) draw_marker(cr, series, x, y);
  }
}

static void draw_series(cairo_t *cr, const frame *f, const scree_panel *panel) {
  cairo_save(cr);
  cairo_rectangle(cr, f->x, f->y, f->width, f->height);
  cairo_clip(cr);
  for (size_t s = 0; s < panel->series_count; s++)
    if (panel->series[s].draw & SCREE_DRAW_BAND) draw_band(cr, f, &panel->series[s]);
  for (size_t s = 0; s < panel->series_count; s++) {
    if (panel->series[s].draw & SCREE_DRAW_LINE) draw_line(cr, f, &panel->series[s]);
    if (panel->series[s].draw & SCREE_DRAW_BARS) draw_bars(cr, f, &panel->series[s]);
  }
  cairo_restore(cr);
  for (size_t s = 0; s < panel->series_count; s++)
    if (panel->series[s].draw & SCREE_DRAW_MARKERS) draw_markers(cr, f, &panel->series[s]);
}

/* ---- axes ---- */

static void draw_grid(cairo_t *cr, const frame *f, const scree_ticks *x, const scree_ticks *y) {
  cairo_set_source_rgb(cr, 0.91, 0.91, 0.91);
  cairo_set_line_width(cr, 0.5);
  for (size_t i = 0; i < x->count; i++) {
    double at = frame_x(f, x->value[i]);
    if (x->label[i][0]) line(cr, at, f->y, at, f->y + f->height);
  }
  for (size_t i = 0; i < y->count; i++) {
    double at = frame_y(f, y->value[i]);
    if (y->label[i][0]) line(cr, f->x, at, f->x + f->width, at);
  }
  cairo_stroke(cr);
}

static void draw_ticks(cairo_t *cr, const frame *f, const scree_ticks *ticks, bool is_y) {
  double right = f->x + f->width, bottom = f->y + f->height;
  for (size_t i = 0; i < ticks->count; i++) {
    const char *label = ticks->label[i];
    double length = *label ? MAJOR_TICK : MINOR_TICK, at = ticks->value[i];
    at = is_y ? frame_y(f, at) : frame_x(f, at);
    if (is_y) {
      line(cr, f->x, at, f->x + length, at);
      line(cr, right, at, right - length, at);
    } else {
      line(cr, at, bottom, at, bottom - length);
      line(cr, at, f->y, at, f->y + length);
    }
    cairo_stroke(cr);
    if (*label && is_y)
      text_draw(cr, label, SMALL_FONT, f->x - 5, at + 0.35 * SMALL_FONT, 1);
    else if (*label)
      text_draw(cr, label, SMALL_FONT, at, bottom + 13, 0.5);
  }
}

static void draw_labels(cairo_t *cr, const frame *f, const scree_panel *panel) {
  if (panel->x.label)
    text_draw(cr, panel->x.label, FONT, f->x + f->width / 2, f->y + f->height + 29, 0.5);
  if (panel->title) text_draw(cr, panel->title, FONT, f->x, f->y - 7, 0);
  if (!panel->y.label) return;
  cairo_save(cr);
  cairo_translate(cr, f->x - LEFT + 13, f->y + f->height / 2);
  cairo_rotate(cr, -acos(-1) / 2);
  text_draw(cr, panel->y.label, FONT, 0, 0, 0.5);
  cairo_restore(cr);
}

static void draw_guides(cairo_t *cr, const frame *f, const scree_panel *panel) {
  static const double dashes[] = {2, 2.5};
  cairo_set_line_width(cr, 0.8);
  for (size_t g = 0; g < panel->guide_count; g++) {
    const scree_guide *guide = &panel->guides[g];
    bool log_axis = (guide->across ? f->y_scale : f->x_scale) == SCREE_SCALE_LOG;
    if (!isfinite(guide->value) || (log_axis && guide->value <= 0)) continue;
    double low = guide->across ? f->y_low : f->x_low, high = guide->across ? f->y_high : f->x_high;
    if (guide->value < low || guide->value > high) continue;
    cairo_set_source_rgb(cr, 0.35, 0.35, 0.35);
    cairo_set_dash(cr, dashes, 2, 0);
    double x = guide->across ? f->x : frame_x(f, guide->value);
    double y = guide->across ? frame_y(f, guide->value) : f->y;
    line(cr, x, y, guide->across ? f->x + f->width : x, guide->across ? y : f->y + f->height);
    cairo_stroke(cr);
    cairo_set_dash(cr, NULL, 0, 0);
    /* above the frame, where no data is, and clear of the title; a line across carries its word
     * on the right end */
    if (guide->label && !guide->across) {
      double left = x - 0.5 * text_width(cr, guide->label, SMALL_FONT);
      if (panel->title) left = fmax(left, f->x + text_width(cr, panel->title, FONT) + SMALL_FONT);
      text_draw(cr, guide->label, SMALL_FONT, left, f->y - 4, 0);
    } else if (guide->label)
      text_draw(cr, guide->label, SMALL_FONT, f->x + f->width - 3, y - 3, 1);
  }
}

static void draw_panel(cairo_t *cr, const scree_panel *panel, const double cell[4]) {
  frame f = {.x = cell[0] + LEFT,
             .y = cell[1] + TOP,
             .width = cell[2] - LEFT - RIGHT,
             .height = cell[3] - TOP - BOTTOM,
             .x_scale = panel->x.scale,
             .y_scale = panel->y.scale};
  scree_ticks x_ticks, y_ticks;
  fit_range(panel, false, &f.x_low, &f.x_high);
  fit_range(panel, true, &f.y_low, &f.y_high);
  scree_ticks_make(f.x_scale, f.x_low, f.x_high, &x_ticks);
  scree_ticks_make(f.y_scale, f.y_low, f.y_high, &y_ticks);
  draw_grid(cr, &f, &x_ticks, &y_ticks);
  draw_guides(cr, &f, panel);
  draw_series(cr, &f, panel);
  cairo_set_source_rgb(cr, INK, INK, INK);
  cairo_set_line_width(cr, 0.8);
  cairo_rectangle(cr, f.x, f.y, f.width, f.height);
  cairo_stroke(cr);
  draw_ticks(cr, &f, &x_ticks, false);
  draw_ticks(cr, &f, &y_ticks, true);
  draw_labels(cr, &f, panel);
}

/* ---- legend and note ---- */

static bool seen_before(const scree_figure *figure, size_t panel, size_t series) {
  const char *label = figure->panels[panel].series[series].label;
  for (size_t p = 0; p <= panel; p++)
    for (size_t s = 0; s < (p == panel ? series : figure->panels[p].series_count); s++) {
      const char *other = figure->panels[p].series[s].label;
      if (other && !strcmp(other, label)) return true;
    }
  return false;
}

static void draw_entry(cairo_t *cr, const scree_series *series, double x, double y) {
  double middle = y - 0.33 * SMALL_FONT;
  if (series->draw & SCREE_DRAW_BAND) {
    set_color(cr, series->style, 0.16);
    cairo_rectangle(cr, x, middle - 4, LEGEND_SAMPLE - 6, 8);
    cairo_fill(cr);
  }
  if (series->draw & SCREE_DRAW_LINE) {
    set_line(cr, series);
    line(cr, x, middle, x + LEGEND_SAMPLE - 6, middle);
    cairo_stroke(cr);
    cairo_set_dash(cr, NULL, 0, 0);
  }
  if (series->draw & SCREE_DRAW_MARKERS)
    draw_marker(cr, series, x + (LEGEND_SAMPLE - 6) / 2, middle);
  cairo_set_source_rgb(cr, INK, INK, INK);
  text_draw(cr, series->label, SMALL_FONT, x + LEGEND_SAMPLE, y, 0);
}

/* Moves to the next series that has an entry of its own, from *panel, *series on. */
static bool next_entry(const scree_figure *figure, size_t *panel, size_t *series) {
  for (; *panel < figure->panel_count; ++*panel, *series = 0)
    for (; *series < figure->panels[*panel].series_count; ++*series)
      if (figure->panels[*panel].series[*series].label && !seen_before(figure, *panel, *series))
        return true;
  return false;
}

static double entry_width(cairo_t *cr, const scree_series *series) {
  return LEGEND_SAMPLE + text_width(cr, series->label, SMALL_FONT) + LEGEND_GAP;
}

/* Draws the entries from *panel, *series on that fit into one row, centred, and moves behind them;
 * only measures with draw false. */
static void legend_row(cairo_t *cr, const scree_figure *figure, const double row[3], bool draw,
                       size_t cursor[2]) {
  double width = 0;
  size_t end[2] = {cursor[0], cursor[1]};
  while (next_entry(figure, &end[0], &end[1])) {
    double next = entry_width(cr, &figure->panels[end[0]].series[end[1]]);
    if (width > 0 && width + next - LEGEND_GAP > row[1]) break;
    width += next;
    end[1]++;
  }
  double x = row[0] + fmax(0, (row[1] - width + LEGEND_GAP) / 2);
  while (draw && next_entry(figure, &cursor[0], &cursor[1]) &&
         (cursor[0] < end[0] || (cursor[0] == end[0] && cursor[1] < end[1]))) {
    const scree_series *series = &figure->panels[cursor[0]].series[cursor[1]];
    draw_entry(cr, series, x, row[2]);
    x += entry_width(cr, series);
    cursor[1]++;
  }
  cursor[0] = end[0];
  cursor[1] = end[1];
}

/* Draws the legend with its top at `top` (only measures with draw false); returns its height. */
static double draw_legend(cairo_t *cr, const scree_figure *figure, double width, double top,
                          bool draw) {
  size_t cursor[2] = {0, 0};
  double height = 0;
  while (next_entry(figure, &cursor[0], &cursor[1])) {
    double row[3] = {LEFT, width - LEFT - RIGHT, top + height + SMALL_FONT};
    legend_row(cr, figure, row, draw, cursor);
    height += LEGEND_ROW;
  }
  return height;
}

static size_t column_count(const scree_figure *figure) {
  size_t columns = figure->columns ? figure->columns : figure->panel_count;
  return columns < figure->panel_count ? columns : figure->panel_count;
}

/* The cell size of one panel. */
static void cell_size(const scree_figure *figure, double *width, double *height) {
  *width = figure->panel_width > 0 ? figure->panel_width : DEFAULT_WIDTH;
  *height = figure->panel_height > 0 ? figure->panel_height : DEFAULT_HEIGHT;
}

static void select_font(cairo_t *cr) {
  cairo_select_font_face(cr, "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
}

/* Size of the whole figure in points. */
static void figure_extent(const scree_figure *figure, double *width, double *height) {
  double cell_width, cell_height;
  cell_size(figure, &cell_width, &cell_height);
  size_t columns = column_count(figure), rows = (figure->panel_count + columns - 1) / columns;
  *width = cell_width * (double)columns;
  cairo_surface_t *surface = cairo_recording_surface_create(CAIRO_CONTENT_COLOR_ALPHA, NULL);
  cairo_t *cr = cairo_create(surface);
  select_font(cr);
  *height = cell_height * (double)rows + draw_legend(cr, figure, *width, 0, false) +
            (figure->note ? NOTE_ROW : 0) + EDGE;
  cairo_destroy(cr);
  cairo_surface_destroy(surface);
}

/* In points from the origin, background included. */
static void figure_draw(const scree_figure *figure, cairo_t *cr) {
  double cell_width, cell_height, width, height;
  cell_size(figure, &cell_width, &cell_height);
  figure_extent(figure, &width, &height);
  size_t columns = column_count(figure), rows = (figure->panel_count + columns - 1) / columns;
  cairo_set_source_rgb(cr, 1, 1, 1);
  cairo_paint(cr);
  select_font(cr);
  for (size_t p = 0; p < figure->panel_count; p++) {
    double cell[4] = {cell_width * (double)(p % columns), cell_height * (double)(p / columns),
                      cell_width, cell_height};
    draw_panel(cr, &figure->panels[p], cell);
  }
  draw_legend(cr, figure, width, cell_height * (double)rows, true);
  if (!figure->note) return;
  cairo_set_source_rgb(cr, 0.45, 0.45, 0.45);
  text_draw(cr, figure->note, NOTE_FONT, width - RIGHT, height - EDGE + 1, 1);
}

/* ---- files: cairo streams into our own, so that a picture appears complete or not at all ---- */

static const double PIXELS_PER_POINT = 2;

/* Never fails: a write that does leaves its mark on the stream, and scree_output_commit, which
 * knows the reason, finds it. */
static cairo_status_t to_stream(void *stream, const unsigned char *bytes, unsigned count) {
  (void)fwrite(bytes, 1, count, stream);
  return CAIRO_STATUS_SUCCESS;
}

static cairo_status_t draw_to(const scree_figure *figure, cairo_surface_t *surface, double scale) {
  cairo_t *cr = cairo_create(surface);
  cairo_scale(cr, scale, scale);
  figure_draw(figure, cr);
  cairo_status_t status = cairo_status(cr);
  cairo_destroy(cr);
  return status;
}

static cairo_status_t write_png(const scree_figure *figure, FILE *stream) {
  double width, height;
  figure_extent(figure, &width, &height);
  cairo_surface_t *surface =
      cairo_image_surface_create(CAIRO_FORMAT_RGB24, (int)ceil(width * PIXELS_PER_POINT),
                                 (int)ceil(height * PIXELS_PER_POINT));
  cairo_status_t status = draw_to(figure, surface, PIXELS_PER_POINT);
  if (status == CAIRO_STATUS_SUCCESS)
    status = cairo_surface_write_to_png_stream(surface, to_stream, stream);
  cairo_surface_destroy(surface);
  return status;
}

static cairo_status_t write_vector(const scree_figure *figure, FILE *stream, bool pdf) {
  double width, height;
  figure_extent(figure, &width, &height);
  cairo_surface_t *surface =
      pdf ? cairo_pdf_surface_create_for_stream(to_stream, stream, width, height)
          : cairo_svg_surface_create_for_stream(to_stream, stream, width, height);
  cairo_status_t status = draw_to(figure, surface, 1);
  cairo_surface_finish(surface);
  if (status == CAIRO_STATUS_SUCCESS) status = cairo_surface_status(surface);
  cairo_surface_destroy(surface);
  return status;
}

scree_status scree_figure_paint(const scree_figure *figure, scree_paint paint, FILE *stream,
                                const char *path, scree_error *error) {
  cairo_status_t drawn = paint == SCREE_PAINT_PNG
                             ? write_png(figure, stream)
                             : write_vector(figure, stream, paint == SCREE_PAINT_PDF);
  if (drawn == CAIRO_STATUS_SUCCESS) return SCREE_OK;
  return scree_fail(error, SCREE_IO, "%s: cannot draw: %s", path, cairo_status_to_string(drawn));
}
