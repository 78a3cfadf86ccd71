/* Turning about an axis: at a speed, by a table of speeds or angles, or to and fro. */
#include "scene/motions/kind.h"

#include <string.h>

#define SCREE_PLAN_ROTATE(ROW, T)                                                                  \
  ROW(T, DIRECTION, axis, (0, 0, 1), "")                                                           \
  ROW(T, VECTOR, through, SCREE_ZERO, -1e6, 1e6, "m", "a point of the axis")                       \
  ROW(T, REAL, speed, NAN, -1e4, 1e4, "rad/s", "right-handed about the axis")                      \
  ROW(T, TABLE, table, 0, 0, "s|rad/s", "[time in s, speed in rad/s], linear between")             \
  ROW(T, TABLE, positions, 0, 0, "s|rad", "or [time in s, angle in rad], linear between")          \
  ROW(T, REAL, amplitude, NAN, 0, 1e3, "rad", "or it rocks so far both ways")                      \
  ROW(T, REAL, frequency, NAN, 0, 1e5, "Hz", "")                                                   \
  ROW(T, REAL, phase, 0, -7, 7, "rad", "of the sine")
SCREE_RECORD_TYPE(scree_plan_rotate, SCREE_PLAN_ROTATE)

static scree_status check_rotate(const scree_reader *r, const void *record) {
  const scree_plan_rotate *t = record;
  const bool there[] = {given(&t->speed), t->table.count > 0, t->positions.count > 0,
                        given(&t->amplitude)};
  SCREE_TRY(scree_plan_one_of(r, &t->place, there, 4, "speed, table, positions, amplitude"));
  if (there[3] != given(&t->frequency))
    return scree_fail_place(r, &t->place, "amplitude and frequency go together");
  return SCREE_OK;
}
SCREE_RECORD_TABLE(scree_plan_rotate, SCREE_PLAN_ROTATE, "rotate", NULL, check_rotate)

static size_t put(const scree_plan_geometry *g, const scree_plan_motion *plan, size_t copy,
                  scree_wall_motion *m) {
  const scree_plan_rotate *t = plan->rotate;
  (void)g, (void)copy;
  m->turns = true;
  memcpy(m->axis, t->axis, sizeof m->axis);
  memcpy(m->through, t->through, sizeof m->through);
  m->speed = given(&t->speed) ? t->speed : 0;
  if (given(&t->amplitude)) scree_motion_take_sine(m, t->amplitude, t->frequency, t->phase);
  scree_motion_take_table(m, &t->table, SCREE_MOTION_SPEEDS);
  scree_motion_take_table(m, &t->positions, SCREE_MOTION_POSITIONS);
  return 1;
}

static bool velocity(const scree_plan_motion *plan, vec3 place, vec3 *v, vec3 *spin) {
  const scree_plan_rotate *t = plan->rotate;
  *spin = vec3_scale(vec3_unit(vec3_load(t->axis)), t->speed);
  *v = vec3_cross(*spin, vec3_sub(place, vec3_load(t->through)));
  return given(&t->speed);
}

static double fastest(const scree_scene *scene, size_t geometry, const scree_plan_motion *plan) {
  const scree_plan_rotate *t = plan->rotate;
  double most = given(&t->speed) ? fabs(t->speed) : 0;
  if (given(&t->amplitude)) most = scree_full_turn * t->frequency * t->amplitude;
  most += scree_motion_largest(&t->table) + scree_motion_steepest(&t->positions);
  return scree_motion_arm(scene, geometry, t->axis, t->through) * most;
}

const scree_motion_kind scree_motion_rotate = {
    .turns = true, .put = put, .velocity = velocity, .fastest = fastest};
