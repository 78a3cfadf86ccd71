/* The fields of geometry that the scene makes a mesh of, and of belts. */
#include "scene/plan_fields.h"

#include "base/vec.h"

#define RECORD scree_plan_loop
static const scree_field loop_fields[] = {
    VECTOR(span, -1e6, 1e6, "m", "from the wheel at `at` to the other"),
    VECTOR(axis, 0, 0, "", "of the wheels, square to the span"),
    REAL(radius, 1e-9, 1e6, "m", "of the wheels"),
    REAL(width, 1e-9, 1e6, "m", "along the axis"),
};
#undef RECORD
static scree_status check_span(const scree_reader *r, const scree_place *place,
                               const double axis[3], const double span[3]) {
  const vec3 a = vec3_load(axis), s = vec3_load(span);
  if (fabs(vec3_dot(a, s)) <= 1e-6 * vec3_norm(a) * vec3_norm(s)) return SCREE_OK;
  return scree_fail_place(r, place, "span must be square to the axis");
}
static scree_status check_loop(const scree_reader *r, const void *record) {
  const scree_plan_loop *l = record;
  if (!given(l->span) || !given(&l->radius) || !given(&l->width))
    return scree_fail_place(r, &l->place, "needs span: [x, y, z], a radius and a width");
  if (!(vec3_norm(vec3_load(l->span)) > 0))
    return scree_fail_place(r, &l->place, "span has no length: a cylinder is round one wheel");
  SCREE_TRY(scree_plan_check_direction(r, &l->place, "axis", l->axis));
  return check_span(r, &l->place, l->axis, l->span);
}
static const scree_plan_loop loop_defaults = {{0}, {0, 1, 0}, NONE, NAN, NAN};
const scree_record scree_plan_loop_record =
    SCREE_RECORD("a loop", loop_fields, loop_defaults, check_loop);

#define RECORD scree_plan_screw
static const scree_field screw_fields[] = {
    VECTOR(axis, 0, 0, "", "from `at` on; the flight is right-handed"),
    REAL(radius, 1e-9, 1e6, "m", "of the flight"),
    REAL(shaft, 1e-9, 1e6, "m", "radius of the shaft"),
    REAL(pitch, 1e-9, 1e6, "m", ""),
    REAL(length, 1e-9, 1e6, "m", ""),
    REAL(thickness, 1e-9, 1e6, "m", "of the flight, along the axis"),
};
#undef RECORD
static scree_status check_screw(const scree_reader *r, const void *record) {
  const scree_plan_screw *s = record;
  if (!given(&s->radius) || !given(&s->shaft) || !given(&s->pitch) || !given(&s->length) ||
      !given(&s->thickness))
    return scree_fail_place(r, &s->place, "needs radius, shaft, pitch, length and thickness");
  if (!(s->shaft < s->radius))
    return scree_fail_place(r, &s->place, "shaft %g m: must be below the radius %g m", s->shaft,
                            s->radius);
  if (!(s->thickness < s->pitch && s->thickness < s->length))
    return scree_fail_place(r, &s->place, "thickness %g m: must be below the pitch and the length",
                            s->thickness);
  if (s->length > 100 * s->pitch)
    return scree_fail_place(r, &s->place, "length %g m: at most 100 times the pitch", s->length);
  return scree_plan_check_direction(r, &s->place, "axis", s->axis);
}
static const scree_plan_screw screw_defaults = {
    .axis = {1, 0, 0}, .radius = NAN, .shaft = NAN, .pitch = NAN, .length = NAN, .thickness = NAN};
const scree_record scree_plan_screw_record =
    SCREE_RECORD("a screw", screw_fields, screw_defaults, check_screw);

#define RECORD scree_plan_sieve
static const scree_field sieve_fields[] = {
    VECTOR(size, 1e-9, 1e6, "m", "along x and y, and its thickness"),
    REAL(hole, 1e-9, 1e6, "m", "diameter"),
    REAL(pitch, 1e-9, 1e6, "m", "from hole to hole, along x and y"),
    REAL(bend, 1e-9, 1e6, "m",
         "radius of the upper face about a line along y above it; not given: flat"),
};
#undef RECORD
static scree_status check_sieve(const scree_reader *r, const void *record) {
  const scree_plan_sieve *s = record;
  if (!given(s->size) || !given(&s->hole) || !given(&s->pitch))
    return scree_fail_place(r, &s->place, "needs size: [x, y, thickness], hole and pitch");
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
static const scree_plan_sieve sieve_defaults = {
    .size = NONE, .hole = NAN, .pitch = NAN, .bend = NAN};
const scree_record scree_plan_sieve_record =
    SCREE_RECORD("a sieve", sieve_fields, sieve_defaults, check_sieve);

#define RECORD scree_plan_belt
static const scree_field belt_fields[] = {
    VECTOR(axis, 0, 0, "", "of its pulleys"),
    REAL(speed, -1e3, 1e3, "m/s", "along itself; above 0 right-handed about the axis"),
};
#undef RECORD
static scree_status check_belt(const scree_reader *r, const void *record) {
  const scree_plan_belt *b = record;
  if (!given(&b->speed)) return scree_fail_place(r, &b->place, "needs a speed");
  return scree_plan_check_direction(r, &b->place, "axis", b->axis);
}
static const scree_plan_belt belt_defaults = {{0}, {0, 1, 0}, NAN};
const scree_record scree_plan_belt_record =
    SCREE_RECORD("a belt", belt_fields, belt_defaults, check_belt);

/* ---- copies ---- */

#define RECORD scree_plan_round
static const scree_field copies_fields[] = {
    COUNT(count, 1, 1000, "of all, at equal distances"),
    VECTOR(axis, 0, 0, "", "about which they stand"),
    VECTOR(through, -1e6, 1e6, "m", "a point of it"),
    VECTOR(
        span, -1e6, 1e6, "m",
        "of a chain: from the wheel there to the other; the first copy begins the strand along it"),
    REAL(radius, 1e-9, 1e6, "m", "of the wheels, to the chain"),
};
#undef RECORD
static scree_status check_copies(const scree_reader *r, const void *record) {
  const scree_plan_round *c = record;
  if (!c->count) return scree_fail_place(r, &c->place, "needs a count");
  if ((vec3_norm(vec3_load(c->span)) > 0) != given(&c->radius))
    return scree_fail_place(r, &c->place, "span and radius go together: they are of a chain");
  SCREE_TRY(scree_plan_check_direction(r, &c->place, "axis", c->axis));
  return check_span(r, &c->place, c->axis, c->span);
}
static const scree_plan_round copies_defaults = {.axis = {0, 0, 1}, .radius = NAN};
const scree_record scree_plan_copies_record =
    SCREE_RECORD("copies", copies_fields, copies_defaults, check_copies);
