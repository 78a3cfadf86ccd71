/* Copies on a chain: each is carried along its way. */
#include "scene/geometry/kind.h"
#include "scene/motions/kind.h"
#include "scene/scene.h"

#include <string.h>

#define SCREE_PLAN_TRAVEL(ROW, T)                                                                  \
  ROW(T, REAL, speed, NAN, -1e3, 1e3, "m/s", "of the chain; above 0 right-handed about the axis")
SCREE_RECORD_TYPE(scree_plan_travel, SCREE_PLAN_TRAVEL)
SCREE_RECORD_TABLE(scree_plan_travel, SCREE_PLAN_TRAVEL, "round", "a speed", NULL)

static scree_status check(const scree_reader *r, const scree_plan_geometry *g,
                          const scree_plan_motion *m) {
  if (g->motion.count == 1 && g->copies && given(&g->copies->radius)) return SCREE_OK;
  return scree_fail_place(r, &m->place,
                          "round is the only motion of copies along a chain: give copies: "
                          "{count, axis, through, span, radius}");
}

static size_t put(const scree_plan_geometry *g, const scree_plan_motion *plan, size_t copy,
                  scree_wall_motion *m) {
  const scree_plan_round *c = g->copies;
  memcpy(m->axis, c->axis, sizeof m->axis);
  memcpy(m->through, c->through, sizeof m->through);
  memcpy(m->span, c->span, sizeof m->span);
  m->radius = c->radius;
  m->start = scree_copy_way(c, copy);
  m->speed = plan->round->speed;
  return 1;
}

/* The speed of what stands out of the chain, as it goes round a wheel. */
static double fastest(const scree_scene *scene, size_t geometry, const scree_plan_motion *plan) {
  const scree_plan_round *c = scene->plan.geometry.items[geometry].copies;
  const double length = vec3_norm(vec3_load(c->span));
  double second[3];
  vec3_store(second, vec3_add(vec3_load(c->through), vec3_load(c->span)));
  const double far = fmin(scree_motion_arm(scene, geometry, c->axis, c->through),
                          scree_motion_arm(scene, geometry, c->axis, second));
  return fabs(plan->round->speed) * fmax(1, (far - length) / c->radius);
}

const scree_motion_kind scree_motion_round = {.check = check, .put = put, .fastest = fastest};
