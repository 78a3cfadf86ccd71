/* A small plot layer: panels with linear or log axes, lines, markers, error bars and bands; one
 * description gives PNG, SVG and PDF (fonts as outlines or embedded), the data as CSV and a gnuplot
 * script that draws the same. The legend stands below the panels, where no data is.
 *
 * Texts are UTF-8 with two marks, _{below} and ^{above}; nothing else is interpreted. */
#pragma once

#include "base/error.h"

#include <stddef.h>

typedef enum scree_scale { SCREE_SCALE_LINEAR, SCREE_SCALE_LOG } scree_scale;

typedef struct scree_axis {
  const char *label;
  scree_scale scale;
  double minimum, maximum; /* both 0: fitted to the data */
} scree_axis;

/* What a series draws; or them together. */
enum {
  SCREE_DRAW_LINE = 1,
  SCREE_DRAW_MARKERS = 2,
  SCREE_DRAW_BARS = 4,     /* from low to high at each point */
  SCREE_DRAW_BAND = 8,     /* shaded from low to high */
  SCREE_DRAW_DASHED = 16,  /* the line */
  SCREE_DRAW_FAINT = 32,   /* a thin, light line: background to the others */
  SCREE_DRAW_UNFITTED = 64 /* the axes take no notice of it; it is cut off at their ends */
};

typedef enum scree_marker {
  SCREE_MARKER_BY_STYLE,
  SCREE_MARKER_CIRCLE,
  SCREE_MARKER_SQUARE,
  SCREE_MARKER_TRIANGLE,
  SCREE_MARKER_DIAMOND,
  SCREE_MARKER_TRIANGLE_DOWN,
  SCREE_MARKER_PENTAGON,
  SCREE_MARKER_PLUS,
  SCREE_MARKER_CROSS,
  SCREE_MARKER_TRIANGLE_LEFT,
  SCREE_MARKER_RING,  /* large and open: goes around another one */
  SCREE_MARKER_FRAME, /* likewise, a square */
  SCREE_MARKER_STAR,  /* large */
  SCREE_MARKER_COUNT
} scree_marker;

enum { SCREE_STYLE_COUNT = 9, SCREE_STYLE_INK = -1 };

/* Points that are not finite, or not positive on a log axis, are left out and cut the line. */
typedef struct scree_series {
  const char *label; /* in the legend; NULL: not there. The same label twice is one entry */
  const double *x, *y;
  const double *low, *high; /* for bars and band, absolute values; NULL: none */
  size_t count;
  unsigned draw;
  int style; /* colour and marker, from 0, repeated after SCREE_STYLE_COUNT; or SCREE_STYLE_INK */
  scree_marker marker;
} scree_series;

/* A line across the panel with a word at its end. */
typedef struct scree_guide {
  const char *label;
  double value; /* on x; on y where across is set */
  bool across;
} scree_guide;

typedef struct scree_panel {
  const char *title; /* NULL: none */
  scree_axis x, y;
  const scree_series *series;
  size_t series_count;
  const scree_guide *guides;
  size_t guide_count;
} scree_panel;

typedef struct scree_figure {
  const scree_panel *panels;
  size_t panel_count, columns;      /* columns 0: all in one row */
  double panel_width, panel_height; /* points, of the whole panel with its labels; 0: 340, 290 */
  const char *note;                 /* small print below, for provenance; NULL: none */
} scree_figure;

/* Writes by the path's ending: .png (2 pixels a point), .svg, .pdf, .csv (panel, series, label, x,
 * y, low, high) or .gnuplot (a script that reads the .csv of the same name). Of a name without an
 * ending all five, but pictures where this build has none. */
scree_status scree_figure_write(const scree_figure *figure, const char *path, bool overwrite,
                                scree_error *error);

/* ---- ticks, for tests ---- */

enum { SCREE_TICK_LIMIT = 128 };

typedef struct scree_ticks {
  double value[SCREE_TICK_LIMIT];
  char label[SCREE_TICK_LIMIT][24]; /* marked up; "" for minor ticks */
  size_t count;
} scree_ticks;

/* Ticks within [low, high]. On a log axis every decade is a major tick and 2..9 are minor ones
 * (labels thin out beyond eight decades; below two decades 2 and 5 are labelled too); on a linear
 * axis majors lie at steps of 1, 2 or 5. */
void scree_ticks_make(scree_scale scale, double low, double high, scree_ticks *ticks);

/* Between the plot's drawing and its files. */
typedef enum scree_paint { SCREE_PAINT_PNG, SCREE_PAINT_SVG, SCREE_PAINT_PDF } scree_paint;
/* The figure as a picture; path is for messages. SCREE_UNSUPPORTED in a build without pictures. */
scree_status scree_figure_paint(const scree_figure *figure, scree_paint paint, FILE *stream,
                                const char *path, scree_error *error);

/* Text with _{below} and ^{above}, in runs. */
enum { SCREE_RUN_BYTES = 256 };
typedef struct scree_text_run {
  char text[SCREE_RUN_BYTES];
  char kind; /* 0, '_' or '^' */
} scree_text_run;
/* The first run of the text; returns what comes after it. */
const char *scree_text_run_next(const char *text, scree_text_run *run);

/* The text without its marks, for files that know none, into buffer of size bytes. */
void scree_text_plain(const char *text, char *buffer, size_t size);
