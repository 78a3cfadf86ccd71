/* The fields of geometry that the scene makes a mesh of, and of belts. */
#include "scene/plan_fields.h"

#include "base/vec.h"

static scree_status check_span(const scree_reader *r, const scree_place *place,
                               const double axis[3], const double span[3]) {
  const vec3 a = vec3_load(axis), s = vec3_load(span);
  if (fabs(vec3_dot(a, s)) <= 1e-6 * vec3_norm(a) * vec3_norm(s)) return SCREE_OK;
  return scree_fail_place(r, place, "span must be square to the axis");
}
static scree_status check_loop(const scree_reader *r, const void *record) {
  const scree_plan_loop *l = record;
  if (!(vec3_norm(vec3_load(l->span)) > 0))
    return scree_fail_place(r, &l->place, "span has no length: a cylinder is round one wheel");
  return check_span(r, &l->place, l->axis, l->span);
}
SCREE_RECORD_TABLE(scree_plan_loop, SCREE_PLAN_LOOP, "a loop",
                   "span: [x, y, z], a radius and a width", check_loop)

static scree_status check_screw(const scree_reader *r, const void *record) {
  const scree_plan_screw *s = record;
  if (!(s->shaft < s->radius))
    return scree_fail_place(r, &s->place, "shaft %g m: must be below the radius %g m", s->shaft,
                            s->radius);
  if (!(s->thickness < s->pitch && s->thickness < s->length))
    return scree_fail_place(r, &s->place, "thickness %g m: must be below the pitch and the length",
                            s->thickness);
  if (s->length > 100 * s->pitch)
    return scree_fail_place(r, &s->place, "length %g m: at most 100 times the pitch", s->length);
  return SCREE_OK;
}
SCREE_RECORD_TABLE(scree_plan_screw, SCREE_PLAN_SCREW, "a screw",
                   "radius, shaft, pitch, length and thickness", check_screw)

static scree_status check_sieve(const scree_reader *r, const void *record) {
  const scree_plan_sieve *s = record;
  if (!(s->hole <= 0.95 * s->pitch))
    return scree_fail_place(r, &s->place, "hole %g m: must be below 0.95 of the pitch, %g m",
                            s->hole, 0.95 * s->pitch);
  if (s->size[0] < s->pitch || s->size[1] < s->pitch ||
      s->size[0] * s->size[1] > 1e4 * s->pitch * s->pitch)
    return scree_fail_place(r, &s->place, "has %.0f holes: 1 to 10000",
                            floor(s->size[0] / s->pitch) * floor(s->size[1] / s->pitch));
  if (given(&s->bend) && s->size[0] > 6 * s->bend)
    return scree_fail_place(r, &s->place, "bend %g m: size along x must be below 6 times that",
                            s->bend);
  return SCREE_OK;
}
SCREE_RECORD_TABLE(scree_plan_sieve, SCREE_PLAN_SIEVE, "a sieve",
                   "size: [x, y, thickness], hole and pitch", check_sieve)

SCREE_RECORD_TABLE(scree_plan_belt, SCREE_PLAN_BELT, "a belt", "a speed", NULL)

/* ---- copies ---- */

static scree_status check_copies(const scree_reader *r, const void *record) {
  const scree_plan_round *c = record;
  if ((vec3_norm(vec3_load(c->span)) > 0) != given(&c->radius))
    return scree_fail_place(r, &c->place, "span and radius go together: they are of a chain");
  return check_span(r, &c->place, c->axis, c->span);
}
SCREE_RECORD_TABLE(scree_plan_round, SCREE_PLAN_ROUND, "copies", "a count", check_copies)
