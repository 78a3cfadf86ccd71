/* The fields of geometry that forces move. */
#include "scene/plan_fields.h"

static scree_status check_servo(const scree_reader *r, const void *record) {
  const scree_plan_servo *s = record;
  if (!given(&s->force) || !given(&s->speed) || s->force == 0)
    return scree_fail_place(r, &s->place, "needs what it keeps, not 0, and a speed");
  return SCREE_OK;
}
static const scree_plan_servo servo_defaults = {{0}, NAN, NAN};

#define RECORD scree_plan_servo
static const scree_field servo_fields[] = {
    REAL(force, -1e12, 1e12, "N", "on bodies, along the slide"),
    REAL(speed, 1e-9, 1e3, "m/s", "at most"),
};
static const scree_field turning_servo_fields[] = {
    {"torque", SCREE_FIELD_REAL, offsetof(RECORD, force), -1e12, 1e12, "N m",
     "on bodies, about the hinge", NULL},
    REAL(speed, 1e-9, 1e4, "rad/s", "at most"),
};
#undef RECORD
static const scree_record servo_record =
                              SCREE_RECORD("servo", servo_fields, servo_defaults, check_servo),
                          turning_servo_record = SCREE_RECORD("servo", turning_servo_fields,
                                                              servo_defaults, check_servo);

#define RECORD scree_plan_part
static const scree_field slide_fields[] = {
    {"along", SCREE_FIELD_VECTOR, offsetof(RECORD, axis), 0, 0, "", "", NULL},
    REAL(mass, 1e-9, 1e12, "kg", ""),
    REAL(spring, 0, 1e15, "N/m", ""),
    REAL(rest, -1e6, 1e6, "m", "way at which the spring is loose"),
    REAL(damper, 0, 1e15, "N s/m", ""),
    REAL(force, -1e12, 1e12, "N", "that drives it"),
    REAL(amplitude, 0, 1e12, "N", "of a force that swings besides"),
    REAL(frequency, 0, 1e5, "Hz", ""),
    REAL(from, 0, 1e9, "s", "held until then"),
    REAL(least, -1e6, 1e6, "m", "where it stops; not given: nowhere"),
    REAL(most, -1e6, 1e6, "m", "likewise"),
    GROUP(servo, "instead of mass and forces", &servo_record),
};
static const scree_field hinge_fields[] = {
    VECTOR(axis, 0, 0, "", ""),
    VECTOR(through, -1e6, 1e6, "m", "a point of the axis"),
    REAL(inertia, 1e-15, 1e15, "kg m2", "about the axis"),
    REAL(mass, 0, 1e12, "kg", "for its weight"),
    VECTOR(centre, -1e6, 1e6, "m", "of mass, at the start; not given: on the axis"),
    REAL(spring, 0, 1e15, "N m/rad", ""),
    REAL(rest, -1e6, 1e6, "rad", "angle at which the spring is loose"),
    REAL(damper, 0, 1e15, "N m s/rad", ""),
    {"torque", SCREE_FIELD_REAL, offsetof(RECORD, force), -1e12, 1e12, "N m", "that drives it",
     NULL},
    REAL(amplitude, 0, 1e12, "N m", "of a torque that swings besides"),
    REAL(frequency, 0, 1e5, "Hz", ""),
    REAL(from, 0, 1e9, "s", "held until then"),
    REAL(least, -1e6, 1e6, "rad", "where it stops; not given: nowhere"),
    REAL(most, -1e6, 1e6, "rad", "likewise"),
    GROUP(servo, "instead of inertia and torques", &turning_servo_record),
};
#undef RECORD

static scree_status check_part(const scree_reader *r, const scree_plan_part *p, double inertia,
                               const char *what) {
  if (!p->servo && isnan(inertia)) return scree_fail_place(r, &p->place, "needs %s", what);
  if (p->servo && (p->spring != 0 || p->damper != 0 || p->force != 0 || p->amplitude != 0))
    return scree_fail_place(r, &p->place, "a servo stands instead of spring, damper and drive");
  if (given(&p->least) && given(&p->most) && !(p->least < p->most))
    return scree_fail_place(r, &p->place, "least %g must be below most %g", p->least, p->most);
  if ((given(&p->least) && p->least > 0) || (given(&p->most) && p->most < 0))
    return scree_fail_place(r, &p->place, "it begins at 0, which must lie between its ends");
  return scree_plan_check_direction(r, &p->place, "its axis", p->axis);
}

static scree_status check_slide(const scree_reader *r, const void *record) {
  const scree_plan_part *p = record;
  return check_part(r, p, p->mass, "a mass or a servo");
}
static scree_status check_hinge(const scree_reader *r, const void *record) {
  const scree_plan_part *p = record;
  return check_part(r, p, p->inertia, "an inertia or a servo");
}

static const scree_plan_part slide_defaults = {
    .axis = {0, 0, 1}, .mass = NAN, .inertia = NAN, .centre = NONE, .least = NAN, .most = NAN};
static const scree_plan_part hinge_defaults = {
    .axis = {0, 0, 1}, .inertia = NAN, .centre = NONE, .least = NAN, .most = NAN};
const scree_record scree_plan_slide_record =
    SCREE_RECORD("a slide", slide_fields, slide_defaults, check_slide);
const scree_record scree_plan_hinge_record =
    SCREE_RECORD("a hinge", hinge_fields, hinge_defaults, check_hinge);
