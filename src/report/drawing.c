#include "report/drawing.h"

#include "base/array.h"

scree_panel *scree_drawing_panel(scree_drawing *d, const char *title, scree_axis x, scree_axis y) {
  const scree_panel panel = {.title = title, .x = x, .y = y};
  if (d->failed || !SCREE_PUSH(&d->panels, panel)) {
    d->failed = true;
    return NULL;
  }
  return &d->panels.items[d->panels.count - 1];
}

void scree_drawing_put(scree_drawing *d, scree_series series) {
  d->failed = d->failed || !SCREE_PUSH(&d->series, series);
  if (!d->failed) d->panels.items[d->panels.count - 1].series_count++;
}

scree_curve_room scree_drawing_add(scree_drawing *d, size_t count, scree_series series) {
  double *room = scree_arena_take(&d->arena, 4 * count + 1, sizeof *room);
  bool range = series.draw & (SCREE_DRAW_BARS | SCREE_DRAW_BAND);
  if (!room) d->failed = true;
  if (d->failed) return (scree_curve_room){0};
  scree_curve_room at = {room, room + count, room + 2 * count, room + 3 * count};
  series.x = at.x;
  series.y = at.y;
  series.low = range ? at.low : NULL;
  series.high = range ? at.high : NULL;
  series.count = count;
  scree_drawing_put(d, series);
  return d->failed ? (scree_curve_room){0} : at;
}

void scree_drawing_free(scree_drawing *d) {
  scree_arena_free(&d->arena);
  scree_free(d->panels.items);
  scree_free(d->series.items);
}

scree_status scree_drawing_write(scree_drawing *d, scree_figure figure, const char *path,
                                 bool overwrite, scree_error *error) {
  const scree_series *first = d->series.items;
  for (size_t p = 0; !d->failed && p < d->panels.count; p++) {
    d->panels.items[p].series = first;
    first += d->panels.items[p].series_count;
  }
  figure.panels = d->panels.items;
  figure.panel_count = d->panels.count;
  scree_status status = d->failed ? scree_fail_memory(error, 0, "a figure")
                                  : scree_figure_write(&figure, path, overwrite, error);
  scree_drawing_free(d);
  return status;
}
