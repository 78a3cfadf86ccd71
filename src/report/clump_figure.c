/* The curve of clumps: (a) what is missed, (b) the criterion, against the number of spheres; a star
 * stands at the recommended count. */
#include "base/alloc.h"
#include "report/plot.h"
#include "report/program.h"

enum { NOTE_BYTES = 256 };

typedef struct panel_data {
  scree_series *series;
  double *values;
  size_t used, series_count;
} panel_data;

static double distance_share(const scree_clumps *clumps, const scree_clump *c) {
  return (c->to_mesh.mean + c->from_mesh.mean) / 2 / clumps->size;
}

static void add_curve(panel_data *d, const scree_clump_entry *entry, int style, bool criterion) {
  const scree_clumps *clumps = entry->clumps;
  double *x = d->values + d->used, *y = x + clumps->clump_count;
  for (size_t i = 0; i < clumps->clump_count; i++) {
    const scree_clump *c = &clumps->clumps[i];
    x[i] = (double)c->sphere_count;
    y[i] = criterion ? c->volume_criterion : 1 - c->iou;
  }
  d->used += 2 * clumps->clump_count;
  d->series[d->series_count++] = (scree_series){.label = entry->name,
                                                .x = x,
                                                .y = y,
                                                .count = clumps->clump_count,
                                                .draw = SCREE_DRAW_LINE,
                                                .style = style};
}

/* Mean distance, both ways, of all entries: dashed, on the same axis as what is missed. */
static void add_distance(panel_data *d, const scree_clump_entry *entry, int style) {
  const scree_clumps *clumps = entry->clumps;
  double *x = d->values + d->used, *y = x + clumps->clump_count;
  for (size_t i = 0; i < clumps->clump_count; i++) {
    x[i] = (double)clumps->clumps[i].sphere_count;
    y[i] = distance_share(clumps, &clumps->clumps[i]);
  }
  d->used += 2 * clumps->clump_count;
  d->series[d->series_count++] = (scree_series){.x = x,
                                                .y = y,
                                                .count = clumps->clump_count,
                                                .draw = SCREE_DRAW_LINE | SCREE_DRAW_DASHED,
                                                .style = style};
}

static void add_choices(panel_data *d, const scree_clump_report *report, bool criterion) {
  double *x = d->values + d->used, *y = x + report->entry_count;
  for (size_t e = 0; e < report->entry_count; e++) {
    const scree_clumps *clumps = report->entries[e].clumps;
    const scree_clump *c = &clumps->clumps[clumps->recommended];
    x[e] = (double)c->sphere_count;
    y[e] = criterion ? c->volume_criterion : 1 - c->iou;
  }
  d->used += 2 * report->entry_count;
  d->series[d->series_count++] = (scree_series){.label = "recommended",
                                                .x = x,
                                                .y = y,
                                                .count = report->entry_count,
                                                .draw = SCREE_DRAW_MARKERS | SCREE_DRAW_UNFITTED,
                                                .style = SCREE_STYLE_INK,
                                                .marker = SCREE_MARKER_STAR};
}

static scree_panel make_panel(const scree_clump_report *report, bool criterion, panel_data *d) {
  for (size_t e = 0; e < report->entry_count; e++) {
    add_curve(d, &report->entries[e], (int)e, criterion);
    if (!criterion) add_distance(d, &report->entries[e], (int)e);
  }
  add_choices(d, report, criterion);
  return (scree_panel){.title = criterion ? "(b) criterion" : "(a) error",
                       .x = {"number of spheres  n", SCREE_SCALE_LOG, 0, 0},
                       .y = {criterion ? "1 - IoU + n/200" : "1 - IoU;  dashed: mean distance/L",
                             SCREE_SCALE_LOG, 0, 0},
                       .series = d->series,
                       .series_count = d->series_count};
}

static scree_status allocate(const scree_clump_report *report, panel_data *d, scree_error *error) {
  size_t points = 2 * report->entry_count;
  for (size_t e = 0; e < report->entry_count; e++)
    points += 4 * report->entries[e].clumps->clump_count;
  d->series = scree_alloc_zero(2 * report->entry_count + 1, sizeof *d->series);
  d->values = scree_alloc(points, sizeof *d->values);
  return d->series && d->values
             ? SCREE_OK
             : scree_fail_memory(error, points * sizeof *d->values, "a figure's data");
}

scree_status scree_clump_figure_write(const scree_clump_report *report, const char *path,
                                      bool overwrite, scree_error *error) {
  if (report->entry_count == 0)
    return scree_fail(error, SCREE_BAD_ARGUMENT, "%s: no clumps to draw", path);
  panel_data data[2] = {{0}, {0}};
  scree_panel panels[2];
  char note[NOTE_BYTES];
  scree_status status = SCREE_OK;
  for (int p = 0; p < 2 && status == SCREE_OK; p++) {
    status = allocate(report, &data[p], error);
    if (status == SCREE_OK) panels[p] = make_panel(report, p == 1, &data[p]);
  }
  if (status == SCREE_OK) {
    snprintf(note, sizeof note, "scree %s, method %s; L: diameter of the sphere of equal volume",
             scree_version(), scree_clump_method_name(report->entries[0].clumps->method));
    scree_figure figure = {.panels = panels, .panel_count = 2, .note = note};
    status = scree_figure_write(&figure, path, overwrite, error);
  }
  for (int p = 0; p < 2; p++) {
    scree_free(data[p].series);
    scree_free(data[p].values);
  }
  return status;
}
