/* Zingg's plot: a point a body, the lines at 2/3 between his four classes. */
#include "report/drawing.h"
#include "report/program.h"

scree_status scree_zingg_figure_write(const scree_measure_entry *entries, size_t entry_count,
                                      const char *path, bool overwrite, scree_error *error) {
  static const scree_guide guides[] = {{"2/3", 2. / 3, false}, {"2/3", 2. / 3, true}};
  scree_drawing d = {0};
  size_t count = 0, filled = 0;
  char note[64];
  for (size_t i = 0; i < entry_count; i++) count += entries[i].described;
  if (!count) return scree_fail(error, SCREE_BAD_ARGUMENT, "%s: no closed body to draw", path);
  scree_panel *panel =
      scree_drawing_panel(&d, "oblate | equant above, bladed | prolate below",
                          (scree_axis){"flatness  S / I", SCREE_SCALE_LINEAR, 0, 1.0001},
                          (scree_axis){"elongation  I / L", SCREE_SCALE_LINEAR, 0, 1.0001});
  if (panel) panel->guides = guides;
  if (panel) panel->guide_count = 2;
  scree_curve_room at = scree_drawing_add(&d, count, (scree_series){.draw = SCREE_DRAW_MARKERS});
  for (size_t i = 0; at.x && i < entry_count; i++) {
    if (!entries[i].described) continue;
    at.x[filled] = entries[i].descriptors.flatness;
    at.y[filled++] = entries[i].descriptors.elongation;
  }
  snprintf(note, sizeof note, "scree %s, %zu bodies", scree_version(), count);
  return scree_drawing_write(&d, (scree_figure){.note = note}, path, overwrite, error);
}
