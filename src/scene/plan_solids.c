/* The fields of geometry that the scene makes a mesh of, and of belts. */
#include "scene/plan_fields.h"

#include "base/vec.h"

#define AT(member) offsetof(scree_plan_loop, member)
static const scree_field loop_fields[] = {
    {"span", SCREE_FIELD_VECTOR, AT(span), -1e6, 1e6, "m", "from the wheel at `at` to the other",
     NULL},
    {"axis", SCREE_FIELD_VECTOR, AT(axis), 0, 0, "", "of the wheels, square to the span", NULL},
    {"radius", SCREE_FIELD_REAL, AT(radius), 1e-9, 1e6, "m", "of the wheels", NULL},
    {"width", SCREE_FIELD_REAL, AT(width), 1e-9, 1e6, "m", "along the axis", NULL},
};
#undef AT
scree_status scree_plan_check_span(const scree_reader *r, const scree_place *place,
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
  scree_status status = scree_plan_check_direction(r, &l->place, "axis", l->axis);
  return status == SCREE_OK ? scree_plan_check_span(r, &l->place, l->axis, l->span) : status;
}
static const scree_plan_loop loop_defaults = {{0}, {0, 1, 0}, NONE, NAN, NAN};
const scree_record scree_plan_loop_record = {"a loop", FIELDS(loop_fields), sizeof(scree_plan_loop),
                                             &loop_defaults, check_loop};

#define AT(member) offsetof(scree_plan_belt, member)
static const scree_field belt_fields[] = {
    {"axis", SCREE_FIELD_VECTOR, AT(axis), 0, 0, "", "of its pulleys", NULL},
    {"speed", SCREE_FIELD_REAL, AT(speed), -1e3, 1e3, "m/s",
     "along itself; above 0 right-handed about the axis", NULL},
};
#undef AT
static scree_status check_belt(const scree_reader *r, const void *record) {
  const scree_plan_belt *b = record;
  if (!given(&b->speed)) return scree_fail_place(r, &b->place, "needs a speed");
  return scree_plan_check_direction(r, &b->place, "axis", b->axis);
}
static const scree_plan_belt belt_defaults = {{0}, {0, 1, 0}, NAN};
const scree_record scree_plan_belt_record = {"a belt", FIELDS(belt_fields), sizeof(scree_plan_belt),
                                             &belt_defaults, check_belt};
