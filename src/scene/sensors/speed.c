/* How fast bodies are: those whose centre is in a box, with a histogram over all ticks. */
#include "scene/sensors/sensor.h"

#define SCREE_PLAN_SPEED(ROW, T)                                                                   \
  ROW(T, GROUP, box, scree_plan_box, "not given: everywhere")                                      \
  ROW(T, REAL, most, 1, 1e-9, 1e6, "m/s", "where the histogram ends; the last bin has the faster") \
  ROW(T, COUNT, bins, 20, 1, 10000, "of the histogram")
SCREE_RECORD_TYPE(scree_plan_speed, SCREE_PLAN_SPEED)
SCREE_RECORD_TABLE(scree_plan_speed, SCREE_PLAN_SPEED, "speed", NULL, NULL)

typedef struct speeds {
  double *counts; /* by bin, of all ticks */
  double ticks;
} speeds;

/* The next body in the box from *index on; its speed. */
static bool next_speed(const scree_scene *scene, const scree_plan_speed *plan, size_t *index,
                       double *speed) {
  scree_body body;
  for (; scree_scene_next_body(scene, index, &body); ++*index) {
    if (!scree_scene_counts(scene, *index)) continue;
    if (plan->box && !scree_is_in(body.position, plan->box->min, plan->box->max)) continue;
    *speed = vec3_norm(vec3_load(body.velocity));
    return true;
  }
  return false;
}

static scree_status begin(scree_scene *scene, scree_scene_sensor *sensor, scree_error *error) {
  speeds *s = sensor->state;
  SCREE_TRY_TAKE(s->counts, &scene->arena, sensor->plan->speed->bins, error);
  return SCREE_OK;
}

static scree_status watch(scree_scene *scene, scree_scene_sensor *sensor, scree_error *error) {
  const scree_plan_speed *plan = sensor->plan->speed;
  speeds *s = sensor->state;
  double speed;
  (void)error;
  if (!scree_sensor_is_on(scene, sensor)) return SCREE_OK;
  for (size_t b = 0; next_speed(scene, plan, &b, &speed); b++) {
    double at = speed / plan->most * (double)plan->bins;
    s->counts[at < (double)plan->bins ? (size_t)at : plan->bins - 1]++;
  }
  s->ticks++;
  return SCREE_OK;
}

static const scree_sensor_column columns[] = {
    {"count", "", SCREE_OF_ALL}, {"mean", "m/s", SCREE_OF_ALL}, {"sd", "m/s", SCREE_OF_ALL}, {0}};

static scree_status read(const scree_scene *scene, const scree_scene_sensor *sensor,
                         const scree_sensor_moment *now, double *at, scree_error *error) {
  double speed, count = 0, mean = 0, squares = 0;
  (void)now, (void)error;
  for (size_t b = 0; next_speed(scene, sensor->plan->speed, &b, &speed); b++) {
    double off = speed - mean;
    mean += off / ++count;
    squares += off * (speed - mean);
  }
  at[0] = count;
  at[1] = count > 0 ? mean : NAN;
  at[2] = count > 1 ? sqrt(squares / (count - 1)) : NAN;
  return SCREE_OK;
}

static void code(scree_codec *c, scree_scene *scene, scree_scene_sensor *sensor) {
  speeds *s = sensor->state;
  (void)scene;
  scree_code_reals(c, s->counts, sensor->plan->speed->bins);
  scree_code_real(c, &s->ticks);
}

/* Bodies in a bin at a tick, the mean; the share of all. */
static scree_status fill(const scree_scene *scene, const scree_scene_sensor *sensor,
                         scree_sensor_rows *rows, scree_error *error) {
  const scree_plan_speed *plan = sensor->plan->speed;
  const speeds *s = sensor->state;
  double all = 0, width = plan->most / (double)plan->bins;
  (void)scene;
  for (size_t b = 0; b < plan->bins; b++) all += s->counts[b];
  for (size_t b = 0; all > 0 && b < plan->bins; b++) {
    const double end = b + 1 < plan->bins ? width * (double)(b + 1) : (double)INFINITY;
    const double row[] = {width * (double)b, end, s->counts[b] / s->ticks, s->counts[b] / all};
    SCREE_TRY(scree_sensor_put_row(rows, row, NULL, error));
  }
  return SCREE_OK;
}

static const scree_sensor_table tables[] = {
    {"speeds",
     false,
     {{"from", "m/s", 0}, {"until", "m/s", 0}, {"bodies", "", 0}, {"share", "", 0}},
     fill},
    {0}};

const scree_sensor_kind scree_sensor_speed = {.state_size = sizeof(speeds),
                                              .columns = columns,
                                              .read = read,
                                              .begin = begin,
                                              .watch = watch,
                                              .code = code,
                                              .tables = tables};
