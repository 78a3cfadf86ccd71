/* A box about its origin. */
#include "scene/geometry/kind.h"

#include "particle/shape.h"

static scree_status make_mesh(const scree_plan_geometry *g, scree_mesh *mesh, scree_error *error) {
  return scree_box_mesh(g->box, mesh, error);
}

const scree_geometry_kind scree_geometry_box = {.closes = true, .mesh = make_mesh};
