/* The fields of motions. */
#include "scene/plan_fields.h"

#include "base/vec.h"

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
