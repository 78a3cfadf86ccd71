/* The curve of clumps: (a) what is missed, (b) the criterion, against the number of spheres; a star
 * stands at the recommended count. */
#include "report/drawing.h"
#include "report/program.h"

static double distance_share(const scree_clumps *clumps, const scree_clump *c) {
  return (c->to_mesh.mean + c->from_mesh.mean) / 2 / clumps->size;
}

static void add_curve(scree_drawing *d, const scree_clump_entry *entry, int style, bool criterion) {
  const scree_clumps *clumps = entry->clumps;
  scree_curve_room at = scree_drawing_add(
      d, clumps->clump_count,
      (scree_series){.label = entry->name, .draw = SCREE_DRAW_LINE, .style = style});
  for (size_t i = 0; at.x && i < clumps->clump_count; i++) {
    const scree_clump *c = &clumps->clumps[i];
    at.x[i] = (double)c->sphere_count;
    at.y[i] = criterion ? c->volume_criterion : 1 - c->iou;
  }
}

/* Mean distance, both ways, of all entries: dashed, on the same axis as what is missed. */
static void add_distance(scree_drawing *d, const scree_clump_entry *entry, int style) {
  const scree_clumps *clumps = entry->clumps;
  scree_curve_room at = scree_drawing_add(
      d, clumps->clump_count,
      (scree_series){.draw = SCREE_DRAW_LINE | SCREE_DRAW_DASHED, .style = style});
  for (size_t i = 0; at.x && i < clumps->clump_count; i++) {
    at.x[i] = (double)clumps->clumps[i].sphere_count;
    at.y[i] = distance_share(clumps, &clumps->clumps[i]);
  }
}

static void add_choices(scree_drawing *d, const scree_clump_report *report, bool criterion) {
  scree_curve_room at =
      scree_drawing_add(d, report->entry_count,
                        (scree_series){.label = "recommended",
                                       .draw = SCREE_DRAW_MARKERS | SCREE_DRAW_UNFITTED,
                                       .style = SCREE_STYLE_INK,
                                       .marker = SCREE_MARKER_STAR});
  for (size_t e = 0; at.x && e < report->entry_count; e++) {
    const scree_clumps *clumps = report->entries[e].clumps;
    const scree_clump *c = &clumps->clumps[clumps->recommended];
    at.x[e] = (double)c->sphere_count;
    at.y[e] = criterion ? c->volume_criterion : 1 - c->iou;
  }
}

static void add_panel(scree_drawing *d, const scree_clump_report *report, bool criterion) {
  scree_drawing_panel(
      d, criterion ? "(b) criterion" : "(a) error",
      (scree_axis){"number of spheres  n", SCREE_SCALE_LOG, 0, 0},
      (scree_axis){criterion ? "1 - IoU + n/200" : "1 - IoU;  dashed: mean distance/L",
                   SCREE_SCALE_LOG, 0, 0});
  for (size_t e = 0; e < report->entry_count; e++) {
    add_curve(d, &report->entries[e], (int)e, criterion);
    if (!criterion) add_distance(d, &report->entries[e], (int)e);
  }
  add_choices(d, report, criterion);
}

scree_status scree_clump_figure_write(const void *what, const char *path, bool overwrite,
                                      scree_error *error) {
  const scree_clump_report *report = what;
  scree_drawing d = {0};
  char note[256];
  if (report->entry_count == 0)
    return scree_fail(error, SCREE_BAD_ARGUMENT, "%s: no clumps to draw", path);
  add_panel(&d, report, false);
  add_panel(&d, report, true);
  snprintf(note, sizeof note, "scree %s, method %s; L: diameter of the sphere of equal volume",
           scree_version(), scree_clump_method_name(report->entries[0].clumps->method));
  return scree_drawing_write(&d, (scree_figure){.note = note}, path, overwrite, error);
}
