/* Moving along a line: at a velocity, or by a table of speeds or ways. */
#include "scene/motions/kind.h"

#include <string.h>

#define SCREE_PLAN_TRANSLATE(ROW, T)                                                               \
  ROW(T, VECTOR, velocity, SCREE_NONE, -1e3, 1e3, "m/s", "")                                       \
  ROW(T, DIRECTION, along, SCREE_NONE, "direction of what the table says")                         \
  ROW(T, TABLE, table, 0, 0, "s|m/s", "[time in s, speed in m/s], linear between")                 \
  ROW(T, TABLE, positions, 0, 0, "s|m", "or [time in s, way in m], linear between")
SCREE_RECORD_TYPE(scree_plan_translate, SCREE_PLAN_TRANSLATE)

static scree_status check_translate(const scree_reader *r, const void *record) {
  const scree_plan_translate *t = record;
  const bool there[] = {given(t->velocity), t->table.count > 0, t->positions.count > 0};
  SCREE_TRY(scree_plan_one_of(r, &t->place, there, 3,
                              "velocity, table (with along), positions (with along)"));
  if (!there[0] && !given(t->along))
    return scree_fail_place(r, &t->place, "a table needs along: [x, y, z]");
  return SCREE_OK;
}
SCREE_RECORD_TABLE(scree_plan_translate, SCREE_PLAN_TRANSLATE, "translate", NULL, check_translate)

static size_t put(const scree_plan_geometry *g, const scree_plan_motion *plan, size_t copy,
                  scree_wall_motion *m) {
  const scree_plan_translate *t = plan->translate;
  const bool constant = given(t->velocity);
  (void)g, (void)copy;
  memcpy(m->axis, constant ? t->velocity : t->along, sizeof m->axis);
  m->speed = constant ? vec3_norm(vec3_load(t->velocity)) : 0;
  if (m->speed == 0 && constant) m->axis[2] = 1; /* stands */
  scree_motion_take_table(m, &t->table, SCREE_MOTION_SPEEDS);
  scree_motion_take_table(m, &t->positions, SCREE_MOTION_POSITIONS);
  return 1;
}

static bool velocity(const scree_plan_motion *plan, vec3 place, vec3 *v, vec3 *spin) {
  (void)place, (void)spin;
  *v = vec3_load(plan->translate->velocity);
  return given(plan->translate->velocity);
}

static double fastest(const scree_scene *scene, size_t geometry, const scree_plan_motion *plan) {
  const scree_plan_translate *t = plan->translate;
  (void)scene, (void)geometry;
  if (given(t->velocity)) return vec3_norm(vec3_load(t->velocity));
  return scree_motion_largest(&t->table) + scree_motion_steepest(&t->positions);
}

const scree_motion_kind scree_motion_translate = {
    .put = put, .velocity = velocity, .fastest = fastest};
