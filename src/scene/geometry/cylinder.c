/* A round sheet about an axis, open at its ends. Its fields are those of a region (plan.h). */
#include "scene/geometry/kind.h"

static scree_status check(const scree_reader *r, const scree_plan_geometry *g) {
  if (!given(g->cylinder->at)) return SCREE_OK;
  return scree_fail_place(r, &g->cylinder->place,
                          "at stands beside the cylinder, as of all geometry, not in it");
}

static bool goes_on(const scree_plan_geometry *g, bool turning) {
  (void)turning;
  return g->cylinder->length == 0;
}

static scree_container container(const scree_plan_geometry *g) {
  scree_plan_cylinder *c = g->cylinder;
  return (scree_container){&c->place, "radius", &c->radius, NULL,
                           c->axis[0] == 0 && c->axis[1] == 0};
}

static scree_status walls(const scree_geometry_making *m, scree_error *error) {
  const scree_plan_cylinder *c = m->copy.cylinder;
  scree_wall wall = {.kind = SCREE_WALL_CYLINDER, .radius = c->radius, .length = c->length};
  scree_geometry_turn(&m->copy, c->axis, wall.axis);
  return scree_geometry_add_wall(m, &wall, error);
}

const scree_geometry_kind scree_geometry_cylinder = {
    .check = check, .goes_on = goes_on, .container = container, .walls = walls};
