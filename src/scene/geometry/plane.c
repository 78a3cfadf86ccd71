/* A plane, solid on the side that its normal points away from. */
#include "scene/geometry/kind.h"

static scree_status check(const scree_reader *r, const scree_plan_geometry *g) {
  return scree_geometry_check_surface(r, g, g->plane);
}

/* One that turns does not look the same a period on. */
static bool goes_on(const scree_plan_geometry *g, bool turning) {
  (void)g;
  return !turning;
}

static scree_status walls(const scree_geometry_making *m, scree_error *error) {
  scree_wall wall = {.kind = SCREE_WALL_PLANE};
  scree_geometry_turn(&m->copy, m->copy.plane, wall.axis);
  return scree_geometry_add_wall(m, &wall, error);
}

const scree_geometry_kind scree_geometry_plane = {
    .check = check, .goes_on = goes_on, .walls = walls};
