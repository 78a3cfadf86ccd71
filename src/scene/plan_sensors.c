/* The fields of sensors. */
#include "scene/plan_fields.h"

SCREE_RECORD_TABLE(scree_plan_flow, SCREE_PLAN_FLOW, "a flow", "through: [x, y, z]", NULL)

SCREE_RECORD_TABLE(scree_plan_region, SCREE_PLAN_REGION, "a region", "a box: {min: ..., max: ...}",
                   NULL)

static scree_status check_pile(const scree_reader *r, const void *record) {
  const scree_plan_pile *p = record;
  if (p->band_low < p->band_high) return SCREE_OK;
  return scree_fail_place(r, &p->place, "band_low %g must be below band_high %g", p->band_low,
                          p->band_high);
}
SCREE_RECORD_TABLE(scree_plan_pile, SCREE_PLAN_PILE, "a pile", NULL, check_pile)

SCREE_RECORD_TABLE(scree_plan_slope, SCREE_PLAN_SLOPE, "a slope", NULL, NULL)

SCREE_RECORD_TABLE(scree_plan_segregation, SCREE_PLAN_SEGREGATION, "segregation",
                   "cells: their side", NULL)

SCREE_RECORD_TABLE(scree_plan_residence, SCREE_PLAN_RESIDENCE, "residence", NULL, NULL)

static scree_status check_impacts(const scree_reader *r, const void *record) {
  const scree_plan_impacts *p = record;
  if (p->least < p->most) return SCREE_OK;
  return scree_fail_place(r, &p->place, "least %g J must be below most %g J", p->least, p->most);
}
SCREE_RECORD_TABLE(scree_plan_impacts, SCREE_PLAN_IMPACTS, "impacts", NULL, check_impacts)

static scree_status check_grid(const scree_reader *r, const void *record) {
  const scree_plan_grid *p = record;
  const bool there[] = {p->box != NULL, p->cylinder != NULL};
  SCREE_TRY(scree_plan_one_of(r, &p->place, there, 2, "box, cylinder"));
  if (!given(p->cells)) return scree_fail_place(r, &p->place, "needs cells: [10, 10, 10]");
  for (int k = 0; k < 3; k++)
    if (p->cells[k] != floor(p->cells[k]))
      return scree_fail_place(r, &p->place, "cells %g: must be whole numbers", p->cells[k]);
  if (p->cells[0] * p->cells[1] * p->cells[2] > 1e6)
    return scree_fail_place(r, &p->place, "%g cells: at most 1e6",
                            p->cells[0] * p->cells[1] * p->cells[2]);
  if (p->cylinder && (!given(p->cylinder->at) || !(p->cylinder->length > 0)))
    return scree_fail_place(r, &p->cylinder->place, "needs at: [x, y, z] and a length above 0");
  return SCREE_OK;
}
SCREE_RECORD_TABLE(scree_plan_grid, SCREE_PLAN_GRID, "a grid", NULL, check_grid)

static scree_status check_sensor(const scree_reader *r, const void *record) {
  const scree_plan_sensor *s = record;
  const bool there[] = {s->flow != NULL,      s->region != NULL,   s->wall != NULL,
                        s->pile != NULL,      s->slope != NULL,    s->segregation != NULL,
                        s->residence != NULL, s->position != NULL, s->impacts != NULL,
                        s->part != NULL,      s->grid != NULL};
  SCREE_TRY(scree_plan_one_of(
      r, &s->place, there, sizeof there / sizeof *there,
      "flow, region, wall, position, part, pile, slope, segregation, residence, impacts, grid"));
  return scree_plan_check_window(r, &s->place, s->from, s->until);
}
SCREE_RECORD_TABLE(scree_plan_sensor, SCREE_PLAN_SENSOR, "a sensor", NULL, check_sensor)
