/* The fields of motions. */
#include "scene/plan_fields.h"

#include "base/vec.h"

#define RECORD scree_plan_translate
static const scree_field translate_fields[] = {
    VECTOR(velocity, -1e3, 1e3, "m/s", ""),
    VECTOR(along, 0, 0, "", "direction of what the table says"),
    TABLE(table, "s|m/s", "[time in s, speed in m/s], linear between"),
    TABLE(positions, "s|m", "or [time in s, way in m], linear between"),
};
#undef RECORD
static scree_status check_translate(const scree_reader *r, const void *record) {
  const scree_plan_translate *t = record;
  const bool there[] = {given(t->velocity), t->table.count > 0, t->positions.count > 0};
  SCREE_TRY(scree_plan_one_of(r, &t->place, there, 3,
                              "velocity, table (with along), positions (with along)"));
  if (!there[0] && !given(t->along))
    return scree_fail_place(r, &t->place, "a table needs along: [x, y, z]");
  return scree_plan_check_direction(r, &t->place, "along", t->along);
}
static const scree_plan_translate translate_defaults = {{0}, NONE, NONE, {0}, {0}};
static const scree_record translate_record =
    SCREE_RECORD("translate", translate_fields, translate_defaults, check_translate);

#define RECORD scree_plan_rotate
static const scree_field rotate_fields[] = {
    VECTOR(axis, 0, 0, "", ""),
    VECTOR(through, -1e6, 1e6, "m", "a point of the axis"),
    REAL(speed, -1e4, 1e4, "rad/s", "right-handed about the axis"),
    TABLE(table, "s|rad/s", "[time in s, speed in rad/s], linear between"),
    TABLE(positions, "s|rad", "or [time in s, angle in rad], linear between"),
    REAL(amplitude, 0, 1e3, "rad", "or it rocks so far both ways"),
    REAL(frequency, 0, 1e5, "Hz", ""),
    REAL(phase, -7, 7, "rad", "of the sine"),
};
#undef RECORD
static scree_status check_rotate(const scree_reader *r, const void *record) {
  const scree_plan_rotate *t = record;
  const bool there[] = {given(&t->speed), t->table.count > 0, t->positions.count > 0,
                        given(&t->amplitude)};
  SCREE_TRY(scree_plan_one_of(r, &t->place, there, 4, "speed, table, positions, amplitude"));
  if (there[3] != given(&t->frequency))
    return scree_fail_place(r, &t->place, "amplitude and frequency go together");
  return scree_plan_check_direction(r, &t->place, "axis", t->axis);
}
static const scree_plan_rotate rotate_defaults = {
    .axis = {0, 0, 1}, .speed = NAN, .amplitude = NAN, .frequency = NAN};
static const scree_record rotate_record =
    SCREE_RECORD("rotate", rotate_fields, rotate_defaults, check_rotate);

#define RECORD scree_plan_vibrate
static const scree_field vibrate_fields[] = {
    VECTOR(along, 0, 0, "", ""),
    REAL(amplitude, 0, 1e3, "m", ""),
    REAL(frequency, 0, 1e5, "Hz", ""),
    REAL(phase, -7, 7, "rad", "of the sine"),
};
#undef RECORD
static scree_status check_vibrate(const scree_reader *r, const void *record) {
  const scree_plan_vibrate *v = record;
  if (!given(&v->amplitude) || !given(&v->frequency))
    return scree_fail_place(r, &v->place, "needs amplitude and frequency");
  return scree_plan_check_direction(r, &v->place, "along", v->along);
}
static const scree_plan_vibrate vibrate_defaults = {{0}, {0, 0, 1}, NAN, NAN, 0};
static const scree_record vibrate_record =
    SCREE_RECORD("vibrate", vibrate_fields, vibrate_defaults, check_vibrate);

#define RECORD scree_plan_crank
static const scree_field crank_fields[] = {
    VECTOR(along, 0, 0, "", "away from the shaft"),
    REAL(radius, 1e-9, 1e3, "m", "of the crank: half the stroke"),
    REAL(rod, 1e-9, 1e6, "m", "its length, more than the radius"),
    REAL(speed, 1e-9, 1e5, "rad/s", "of the shaft"),
    REAL(phase, -7, 7, "rad", "at the start; 0: farthest out"),
};
#undef RECORD
static scree_status check_crank(const scree_reader *r, const void *record) {
  const scree_plan_crank *c = record;
  if (!given(&c->radius) || !given(&c->rod) || !given(&c->speed))
    return scree_fail_place(r, &c->place, "needs radius, rod and speed");
  if (!(c->rod > c->radius))
    return scree_fail_place(r, &c->place, "rod %g m: must be longer than the radius %g m", c->rod,
                            c->radius);
  return scree_plan_check_direction(r, &c->place, "along", c->along);
}
static const scree_plan_crank crank_defaults = {{0}, {0, 0, 1}, NAN, NAN, NAN, 0};
static const scree_record crank_record =
    SCREE_RECORD("a crank", crank_fields, crank_defaults, check_crank);

static const scree_field travel_fields[] = {
    {"speed", SCREE_FIELD_REAL, offsetof(scree_plan_travel, speed), -1e3, 1e3, "m/s",
     "of the chain; above 0 right-handed about the axis", NULL},
};
static scree_status check_travel(const scree_reader *r, const void *record) {
  const scree_plan_travel *t = record;
  return given(&t->speed) ? SCREE_OK : scree_fail_place(r, &t->place, "needs a speed");
}
static const scree_plan_travel travel_defaults = {{0}, NAN};
static const scree_record travel_record =
    SCREE_RECORD("round", travel_fields, travel_defaults, check_travel);

#define RECORD scree_plan_path
static const scree_field path_fields[] = {
    TEXT(file, "a table: t and any of x, y, z, angle_x, angle_y, angle_z, with units as `x [mm]`"),
    VECTOR(through, -1e6, 1e6, "m", "about which it turns, by angle_x first"),
};
#undef RECORD
static scree_status check_path(const scree_reader *r, const void *record) {
  const scree_plan_path *p = record;
  return p->file ? SCREE_OK : scree_fail_place(r, &p->place, "needs a file");
}
static const scree_plan_path path_defaults = {.file = NULL};
static const scree_record path_record =
    SCREE_RECORD("a path", path_fields, path_defaults, check_path);

#define RECORD scree_plan_motion
static const scree_field motion_fields[] = {
    GROUP(translate, "", &translate_record),
    GROUP(rotate, "", &rotate_record),
    GROUP(vibrate, "", &vibrate_record),
    GROUP(crank, "to and fro by crank and rod", &crank_record),
    GROUP(round, "of copies along a chain: with it", &travel_record),
    GROUP(path, "by a table in a file", &path_record),
    WINDOW(scree_plan_motion),
    TEXT(during, "a phase: only while it lasts"),
};
#undef RECORD
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
static const scree_plan_motion motion_defaults = {.until = NAN};
const scree_record scree_plan_motion_record =
    SCREE_RECORD("a motion", motion_fields, motion_defaults, check_motion);
