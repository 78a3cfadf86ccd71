/* Zingg's plot: a point a body, the lines at 2/3 between his four classes. */
#include "base/alloc.h"
#include "report/plot.h"
#include "report/program.h"

static void gather(const scree_measure_entry *entries, size_t entry_count, double *x, double *y,
                   size_t *count) {
  for (size_t i = 0; i < entry_count; i++) {
    if (!entries[i].described) continue;
    x[*count] = entries[i].descriptors.flatness;
    y[(*count)++] = entries[i].descriptors.elongation;
  }
}

scree_status scree_zingg_figure_write(const scree_measure_entry *entries, size_t entry_count,
                                      const char *path, bool overwrite, scree_error *error) {
  double *x = scree_alloc(2 * entry_count, sizeof *x), *y = x ? x + entry_count : NULL;
  size_t count = 0;
  if (!x) return scree_fail_memory(error, 2 * entry_count * sizeof *x, "a figure's data");
  gather(entries, entry_count, x, y, &count);
  const scree_guide guides[] = {{"2/3", 2. / 3, false}, {"2/3", 2. / 3, true}};
  const scree_series points = {.x = x, .y = y, .count = count, .draw = SCREE_DRAW_MARKERS};
  const scree_panel panel = {.title = "oblate | equant above, bladed | prolate below",
                             .x = {"flatness  S / I", SCREE_SCALE_LINEAR, 0, 1.0001},
                             .y = {"elongation  I / L", SCREE_SCALE_LINEAR, 0, 1.0001},
                             .series = &points,
                             .series_count = 1,
                             .guides = guides,
                             .guide_count = 2};
  char note[64];
  snprintf(note, sizeof note, "scree %s, %zu bodies", scree_version(), count);
  const scree_figure figure = {.panels = &panel, .panel_count = 1, .note = note};
  scree_status status =
      count ? scree_figure_write(&figure, path, overwrite, error)
            : scree_fail(error, SCREE_BAD_ARGUMENT, "%s: no closed body to draw", path);
  scree_free(x);
  return status;
}
