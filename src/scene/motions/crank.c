/* The motion to and fro along a line by a crank and a rod. */
#include "scene/motions/kind.h"

#include <string.h>

#define SCREE_PLAN_CRANK(ROW, T)                                                                   \
  ROW(T, DIRECTION, along, (0, 0, 1), "away from the shaft")                                       \
  ROW(T, REAL, radius, NAN, 1e-9, 1e3, "m", "of the crank: half the stroke")                       \
  ROW(T, REAL, rod, NAN, 1e-9, 1e6, "m", "its length, more than the radius")                       \
  ROW(T, REAL, speed, NAN, 1e-9, 1e5, "rad/s", "of the shaft")                                     \
  ROW(T, REAL, phase, 0, -7, 7, "rad", "at the start; 0: farthest out")
SCREE_RECORD_TYPE(scree_plan_crank, SCREE_PLAN_CRANK)

static scree_status check_crank(const scree_reader *r, const void *record) {
  const scree_plan_crank *c = record;
  if (c->rod > c->radius) return SCREE_OK;
  return scree_fail_place(r, &c->place, "rod %g m: must be longer than the radius %g m", c->rod,
                          c->radius);
}
SCREE_RECORD_TABLE(scree_plan_crank, SCREE_PLAN_CRANK, "a crank", "radius, rod and speed",
                   check_crank)

static size_t put(const scree_plan_geometry *g, const scree_plan_motion *plan, size_t copy,
                  scree_wall_motion *m) {
  const scree_plan_crank *c = plan->crank;
  (void)g, (void)copy;
  memcpy(m->axis, c->along, sizeof m->axis);
  scree_motion_take_sine(m, c->radius, c->speed / scree_full_turn, c->phase);
  m->law = SCREE_MOTION_CRANK;
  m->rod = c->rod;
  return 1;
}

static double fastest(const scree_scene *scene, size_t geometry, const scree_plan_motion *plan) {
  const scree_plan_crank *c = plan->crank;
  (void)scene, (void)geometry;
  return c->speed * c->radius * (1 + c->radius / c->rod);
}

const scree_motion_kind scree_motion_crank = {.put = put, .fastest = fastest};
