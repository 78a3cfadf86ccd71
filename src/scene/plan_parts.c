/* The fields of geometry that forces move. */
#include "scene/plan_fields.h"

static scree_status check_servo(const scree_reader *r, const void *record) {
  const scree_plan_servo *s = record;
  if (!given(&s->force) || !given(&s->speed) || s->force == 0)
    return scree_fail_place(r, &s->place, "needs what it keeps, not 0, and a speed");
  return SCREE_OK;
}
SCREE_RECORD_TABLE(scree_plan_servo, SCREE_PLAN_SERVO, "servo", NULL, check_servo)
SCREE_RECORD_TABLE(scree_plan_turning_servo, SCREE_PLAN_TURNING_SERVO, "servo", NULL, check_servo)

static scree_status check_part(const scree_reader *r, const scree_plan_part *p, double inertia,
                               const char *what) {
  if (!p->servo && isnan(inertia)) return scree_fail_place(r, &p->place, "needs %s", what);
  if (p->servo && (p->spring != 0 || p->damper != 0 || p->force != 0 || p->amplitude != 0))
    return scree_fail_place(r, &p->place, "a servo stands instead of spring, damper and drive");
  if (given(&p->least) && given(&p->most) && !(p->least < p->most))
    return scree_fail_place(r, &p->place, "least %g must be below most %g", p->least, p->most);
  if ((given(&p->least) && p->least > 0) || (given(&p->most) && p->most < 0))
    return scree_fail_place(r, &p->place, "it begins at 0, which must lie between its ends");
  return SCREE_OK;
}

static scree_status check_slide(const scree_reader *r, const void *record) {
  const scree_plan_part *p = record;
  return check_part(r, p, p->mass, "a mass or a servo");
}
static scree_status check_hinge(const scree_reader *r, const void *record) {
  const scree_plan_part *p = record;
  return check_part(r, p, p->inertia, "an inertia or a servo");
}

SCREE_RECORD_TABLE(scree_plan_slide, SCREE_PLAN_SLIDE, "a slide", NULL, check_slide)
SCREE_RECORD_TABLE(scree_plan_hinge, SCREE_PLAN_HINGE, "a hinge", NULL, check_hinge)
