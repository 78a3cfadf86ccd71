/* Figures in the making: panels and their series, whose numbers lie in one arena. Memory that is
 * not there is told in the end. */
#pragma once

#include "base/arena.h"
#include "report/plot.h"

typedef struct scree_drawing {
  scree_arena arena;
  struct {
    scree_panel *items;
    size_t count, capacity;
  } panels;
  struct {
    scree_series *items;
    size_t count, capacity;
  } series;
  bool failed; /* memory is out */
} scree_drawing;

/* The numbers of a series, to be filled in; all NULL where memory is out. */
typedef struct scree_curve_room {
  double *x, *y, *low, *high;
} scree_curve_room;

/* Series that follow are of this panel. NULL where memory is out. */
scree_panel *scree_drawing_panel(scree_drawing *drawing, const char *title, scree_axis x,
                                 scree_axis y);
/* A series of the last panel with room for `count` points; low and high are drawn where bars or a
 * band are. */
scree_curve_room scree_drawing_add(scree_drawing *drawing, size_t count, scree_series series);
/* One whose numbers are there already. */
void scree_drawing_put(scree_drawing *drawing, scree_series series);

/* All panels, as `figure` has it besides, by scree_figure_write. Frees the drawing. */
scree_status scree_drawing_write(scree_drawing *drawing, scree_figure figure, const char *path,
                                 bool overwrite, scree_error *error);
/* Frees one that is not written after all. */
void scree_drawing_free(scree_drawing *drawing);
