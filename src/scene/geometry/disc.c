/* A round plate without thickness. */
#include "scene/geometry/kind.h"

#define SCREE_PLAN_DISC(ROW, T)                                                                    \
  ROW(T, REAL, radius, NAN, 1e-9, 1e6, "m", "")                                                    \
  ROW(T, DIRECTION, normal, (0, 0, 1), "")
SCREE_RECORD_TYPE(scree_plan_disc, SCREE_PLAN_DISC)
SCREE_RECORD_TABLE(scree_plan_disc, SCREE_PLAN_DISC, "a disc", "a radius", NULL)

static scree_status check(const scree_reader *r, const scree_plan_geometry *g) {
  return scree_geometry_check_surface(r, g, g->disc->normal);
}

static scree_status walls(const scree_geometry_making *m, scree_error *error) {
  scree_wall wall = {.kind = SCREE_WALL_DISC, .radius = m->copy.disc->radius};
  scree_geometry_turn(&m->copy, m->copy.disc->normal, wall.axis);
  return scree_geometry_add_wall(m, &wall, error);
}

const scree_geometry_kind scree_geometry_disc = {.check = check, .walls = walls};
