/* What fields of geometry must be together. */
#include "scene/plan_fields.h"

#include "base/vec.h"

/* ---- meshes that a scene makes, and belts ---- */

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

/* ---- motions ---- */

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

SCREE_RECORD_TABLE(scree_plan_vibrate, SCREE_PLAN_VIBRATE, "vibrate", "amplitude and frequency",
                   NULL)

static scree_status check_crank(const scree_reader *r, const void *record) {
  const scree_plan_crank *c = record;
  if (!(c->rod > c->radius))
    return scree_fail_place(r, &c->place, "rod %g m: must be longer than the radius %g m", c->rod,
                            c->radius);
  return SCREE_OK;
}
SCREE_RECORD_TABLE(scree_plan_crank, SCREE_PLAN_CRANK, "a crank", "radius, rod and speed",
                   check_crank)

SCREE_RECORD_TABLE(scree_plan_travel, SCREE_PLAN_TRAVEL, "round", "a speed", NULL)

SCREE_RECORD_TABLE(scree_plan_path, SCREE_PLAN_PATH, "a path", "a file", NULL)

static scree_status check_motion(const scree_reader *r, const void *record) {
  const scree_plan_motion *m = record;
  const bool there[] = {m->translate != NULL, m->rotate != NULL, m->vibrate != NULL,
                        m->crank != NULL,     m->round != NULL,  m->path != NULL};
  scree_status status =
      scree_plan_one_of(r, &m->place, there, 6, "translate, rotate, vibrate, crank, round, path");
  bool constant =
      (m->translate && given(m->translate->velocity)) || (m->rotate && given(&m->rotate->speed));
  if (status == SCREE_OK && m->during && !constant)
    status = scree_fail_place(
        r, &m->place,
        "during a phase only a translate with a velocity or a rotate with a speed may act");
  if (status == SCREE_OK && m->during && (m->from > 0 || given(&m->until)))
    status = scree_fail_place(r, &m->place, "during stands instead of from and until");
  return status == SCREE_OK ? scree_plan_check_window(r, &m->place, m->from, m->until) : status;
}
SCREE_RECORD_TABLE(scree_plan_motion, SCREE_PLAN_MOTION, "a motion", NULL, check_motion)

/* ---- what forces move ---- */

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
