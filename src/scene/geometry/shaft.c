/* Four endless planes about a vertical axis. */
#include "scene/geometry/kind.h"

#define SCREE_PLAN_SHAFT(ROW, T)                                                                   \
  ROW(T, REAL, width, NAN, 1e-9, 1e6, "m",                                                         \
      "inside, along x; with layers in it not given: as wide as what they pour will be high")      \
  ROW(T, REAL, depth, NAN, 1e-9, 1e6, "m", "along y; not given: the width")
SCREE_RECORD_TYPE(scree_plan_shaft, SCREE_PLAN_SHAFT)
SCREE_RECORD_TABLE(scree_plan_shaft, SCREE_PLAN_SHAFT, "a shaft", NULL, NULL)

static scree_container container(const scree_plan_geometry *g) {
  scree_plan_shaft *s = g->shaft;
  return (scree_container){&s->place, "width", &s->width, &s->depth, true};
}

static scree_status walls(const scree_geometry_making *m, scree_error *error) {
  const scree_plan_shaft *s = m->copy.shaft;
  for (int side = 0; side < 4; side++) {
    int k = side / 2;
    double half = 0.5 * (k ? s->depth : s->width), inwards = side % 2 ? -1 : 1;
    scree_geometry_making one = *m;
    scree_wall wall = {.kind = SCREE_WALL_PLANE};
    double normal[3] = {0, 0, 0};
    normal[k] = inwards;
    one.copy.at[k] -= inwards * half;
    scree_geometry_turn(&m->copy, normal, wall.axis);
    SCREE_TRY(scree_geometry_add_wall(&one, &wall, error));
  }
  return SCREE_OK;
}

const scree_geometry_kind scree_geometry_shaft = {.container = container, .walls = walls};
