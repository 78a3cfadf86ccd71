/* Copies of a geometry: at equal ways round two wheels `span` apart, of which one is at `through`,
 * from the strand that leads to the other on; without a span about the axis. */
#include "scene/geometry/kind.h"

#include "world/state/loop.h"

static scree_status check_copies(const scree_reader *r, const void *record) {
  const scree_plan_round *c = record;
  if ((vec3_norm(vec3_load(c->span)) > 0) != given(&c->radius))
    return scree_fail_place(r, &c->place, "span and radius go together: they are of a chain");
  return scree_geometry_check_span(r, &c->place, c->axis, c->span);
}
SCREE_RECORD_TABLE(scree_plan_round, SCREE_PLAN_ROUND, "copies", "a count", check_copies)

/* The way of copies; about an axis alone it is round a wheel of 1 m. */
static scree_loop loop_of(const scree_plan_round *round) {
  return (scree_loop){vec3_unit(vec3_load(round->axis)), vec3_load(round->through),
                      vec3_load(round->span), isnan(round->radius) ? 1 : round->radius};
}

double scree_copy_way(const scree_plan_round *round, size_t copy) {
  const scree_loop loop = loop_of(round);
  return scree_loop_length(&loop) * (double)copy / (double)round->count;
}

scree_plan_geometry scree_copy_of(const scree_plan_geometry *g, size_t copy,
                                  scree_plan_turn *turn) {
  scree_plan_geometry one = *g;
  if (copy == 0) return one;
  const scree_loop loop = loop_of(g->copies);
  const scree_loop_place place = scree_loop_at(&loop, scree_copy_way(g->copies, copy));
  const quat q = quat_mul(place.turn, scree_geometry_turn_of(g));
  const vec3 axis = {q.x, q.y, q.z};
  *turn = (scree_plan_turn){.axis = {0, 0, 1},
                            .angle_deg = 2 * scree_atan2(vec3_norm(axis), q.w) / SCREE_DEGREE};
  if (vec3_norm(axis) > 0) vec3_store(turn->axis, axis);
  vec3_store(one.at, scree_loop_carry(&loop, &place, vec3_load(g->at)));
  one.turn = turn;
  return one;
}
