/* A sheet round two wheels, of which one is at the geometry's origin; its facets face away from
 * them. Its arcs have ARC edges in a half circle: to 3e-4 of the radius. */
#include "scene/geometry/solid.h"

#include "world/state/loop.h"

#define SCREE_PLAN_LOOP(ROW, T)                                                                    \
  ROW(T, VECTOR, span, SCREE_NONE, -1e6, 1e6, "m", "from the wheel at `at` to the other")          \
  ROW(T, DIRECTION, axis, (0, 1, 0), "of the wheels, square to the span")                          \
  ROW(T, REAL, radius, NAN, 1e-9, 1e6, "m", "of the wheels")                                       \
  ROW(T, REAL, width, NAN, 1e-9, 1e6, "m", "along the axis")
SCREE_RECORD_TYPE(scree_plan_loop, SCREE_PLAN_LOOP)

static scree_status check_loop(const scree_reader *r, const void *record) {
  const scree_plan_loop *l = record;
  if (!(vec3_norm(vec3_load(l->span)) > 0))
    return scree_fail_place(r, &l->place, "span has no length: a cylinder is round one wheel");
  return scree_geometry_check_span(r, &l->place, l->axis, l->span);
}
SCREE_RECORD_TABLE(scree_plan_loop, SCREE_PLAN_LOOP, "a loop",
                   "span: [x, y, z], a radius and a width", check_loop)

enum { ARC = 60 };

static scree_status make_mesh(const scree_plan_geometry *g, scree_mesh *mesh, scree_error *error) {
  const scree_plan_loop *plan = g->loop;
  const scree_loop loop = {
      vec3_unit(vec3_load(plan->axis)), {0, 0, 0}, vec3_load(plan->span), plan->radius};
  const double strand = vec3_norm(loop.span), half = scree_loop_length(&loop) / 2;
  const vec3 w = vec3_cross(loop.axis, vec3_unit(loop.span)), begin = vec3_scale(w, -loop.radius),
             aside = vec3_scale(loop.axis, 0.5 * plan->width);
  const uint32_t ring = 2 * (ARC + 1);
  scree_mesh made = {0};
  SCREE_TRY(scree_solid_reserve(&made, 2 * ring, 2 * ring, error));
  for (uint32_t k = 0; k < ring; k++) {
    const double s = k / (ARC + 1) * half + strand + k % (ARC + 1) * (half - strand) / ARC;
    const scree_loop_place place = scree_loop_at(&loop, s);
    const vec3 at = scree_loop_carry(&loop, &place, begin);
    scree_solid_vertex(&made, vec3_sub(at, aside));
    scree_solid_vertex(&made, vec3_add(at, aside));
  }
  for (uint32_t k = 0; k < ring; k++) {
    const uint32_t a = 2 * k, b = 2 * ((k + 1) % ring);
    scree_solid_quad(&made, a, b, b + 1, a + 1);
  }
  *mesh = made;
  return SCREE_OK;
}

const scree_geometry_kind scree_geometry_loop = {.runs = true, .mesh = make_mesh};
